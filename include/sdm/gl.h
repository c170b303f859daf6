/// The gl engine: surface distance maps by rasterisation on OpenGL (Sud et al. 2006): options and report.
///
/// Threads: all functions may be called concurrently; an engine may serve several threads at once.
#pragma once

#include <sdm/api.h>
#include <sdm/engine.h>
#include <sdm/names.h>
#include <sdm/options.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

/// A device that supports OpenGL 4.5.
struct GlDevice {
  std::string name;    ///< the driver's GL_RENDERER
  std::string driver;  ///< its GL_VERSION
  bool software = false;
};

/// All devices that can run the gl engine, in order of preference: hardware first. Needs neither a window nor
/// a display server. Throws sdm::Error if there is none, or if sdm was built without OpenGL (SDM_BUILD_GL).
[[nodiscard]] SDM_API std::vector<GlDevice> gl_devices();

/// How the polygons of sites are clipped to the faces of O1.
enum class GlClip {
  planes,   ///< clipped to the face's edges before drawing; fragments look up their texel's owner
  stencil,  ///< the paper's method (4.1): a stencil value per face, assigned by a cache
};

template <>
inline constexpr std::array kWords<GlClip>{"planes", "stencil"};

/// Options of make_gl_engine().
struct GlOptions {
  /// Index into gl_devices(), or a part of a name in it (case-insensitive); empty selects the first device.
  std::string device{};
  GlClip clip = GlClip::planes;
  /// Number of stencil values that the faces share, in [1, 255]; used by GlClip::stencil only.
  int stencil_values = 255;
  /// Skip sites that are farther from a face than an upper bound on its distances (4.2). Does not affect the
  /// distances.
  bool bound_culling = true;
};

template <>
inline constexpr auto kOptions<GlOptions> = std::tuple{
    Option{.name = "device",
           .member = &GlOptions::device,
           .text = "The device, by its number in `sdm devices` or part of its name.",
           .value = "NAME"},
    Option{.name = "clip",
           .member = &GlOptions::clip,
           .text = "How polygons are clipped to faces of O1: by planes or, as in the paper, by a stencil "
                   "cache."},
    Option{.name = "stencil_values",
           .member = &GlOptions::stencil_values,
           .text = "Of the clip stencil: the number of stencil values.",
           .range = {1, 255},
           .value = "K"},
    Option{.name = "bound_culling",
           .member = &GlOptions::bound_culling,
           .text = "Cull sites by upper bounds on the distance; the map is the same without."}};

/// Returns the device that `options` selects for maps whose longer side has `resolution` texels. Throws
/// sdm::Error if there is none, or if its largest image is smaller; programs can thus fail before they build
/// a surface.
[[nodiscard]] SDM_API GlDevice gl_device(std::uint32_t resolution, const GlOptions& options = {});

/// Counters and times of the gl engine. Counts do not depend on the number of threads. A pair is a site of O2
/// and a tile of O1 (the texels of one face in a square of 16 × 16 texels). Each pair has exactly one
/// outcome:
///   pairs = culled_by_bound + culled_by_obb + clipped_away + polygons.
struct GlReport {
  GlDevice device;
  GlClip clip = GlClip::planes;

  std::uint64_t sites = 0;          ///< of O2
  std::uint64_t sites_dropped = 0;  ///< sites whose region of influence has no interior; in no pair
  std::uint64_t faces = 0;          ///< of O1 that own a texel
  std::uint64_t tiles = 0;          ///< of those faces
  std::uint64_t pairs = 0;          ///< (sites − sites_dropped) × tiles
  /// Tests of a site or group of sites against a node of O1's tree. Without bound_culling all nodes share one
  /// bound: max_distance, or an upper bound on all distances.
  std::uint64_t bound_tests = 0;
  std::uint64_t obb_tests = 0;  ///< tests of a region's oriented box against a node of O1's tree
  std::uint64_t culled_by_bound = 0;
  std::uint64_t culled_by_obb = 0;
  std::uint64_t clipped_away = 0;  ///< region does not intersect the tile
  std::uint64_t polygons = 0;      ///< drawn
  std::uint64_t fragments = 0;     ///< shaded, and inside their region (planes: and face)
  std::uint64_t texels = 0;        ///< owned by a face: fragments / texels is the overdraw
  std::uint64_t batches = 0;       ///< of polygons sent to the device
  /// Texels whose site is farther than the distance drawn; their closest site is recomputed by the cpu
  /// engine. 0 unless the driver is faulty.
  std::uint64_t unconfirmed = 0;

  // GlClip::stencil only, otherwise 0. lookups = hits + misses; misses − evictions is the number of values in
  // use at the end.
  std::uint64_t stencil_lookups = 0;
  std::uint64_t stencil_hits = 0;
  std::uint64_t stencil_misses = 0;
  std::uint64_t stencil_evictions = 0;
  /// Clears of a face's texels, one per eviction, and of the whole buffer, once at the start.
  std::uint64_t stencil_clears = 0;

  /// Wall-clock milliseconds. The device draws while the next batch is culled and clipped.
  struct Times {
    double context = 0;    ///< device and shaders: close to 0 except for the first map of a process
    double refit = 0;      ///< affine maps, boxes of O1's tree
    double bounds = 0;     ///< upper bounds on distance
    double cull = 0;       ///< bounds, oriented boxes, clipping
    double draw = 0;       ///< upload, stencil, draw calls
    double read_back = 0;  ///< waiting for the device, reading
    double finish = 0;     ///< closest points in double precision, sign
  } time_ms;
};

/// Returns a gl engine with these options. The first map opens the device; a process draws one map at a time.
/// Throws sdm::Error for stencil_values out of range, or if sdm was built without OpenGL.
[[nodiscard]] SDM_API std::shared_ptr<const Engine> make_gl_engine(const GlOptions& options);

/// Returns the report of the last map that a gl engine completed; empty if it has not completed one, or for
/// any other engine.
[[nodiscard]] SDM_API std::optional<GlReport> gl_report(const Engine& engine);

}  // namespace sdm
