/// The gl engine: surface distance maps by rasterisation on OpenGL (Sud et al. 2006): options and report.
#pragma once

#include <sdm/api.h>
#include <sdm/engine.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sdm {

/// A device that OpenGL 4.5 runs on.
struct GlDevice {
  std::string name;    ///< the driver's GL_RENDERER
  std::string driver;  ///< its GL_VERSION
  bool software = false;
};

/// All devices that can run the gl engine, in order of preference: hardware first. Needs
/// neither a window nor a display server. Throws sdm::Error where there is none, or where sdm was built
/// without OpenGL (SDM_BUILD_GL).
[[nodiscard]] SDM_API std::vector<GlDevice> gl_devices();

/// How the polygons of sites are clipped to the faces of O1.
enum class GlClip {
  planes,   ///< cut at the face's sides before they are drawn; fragments look up who owns their texel
  stencil,  ///< the paper's method (4.1): each face has a stencil value, assigned by a cache
};

struct GlOptions {
  /// Index into gl_devices() or a part of a name there, in any case; empty: the first one.
  std::string device{};
  GlClip clip = GlClip::planes;
  /// Stencil values that faces share, in [1, 255]; for GlClip::stencil.
  int stencil_values = 255;
  /// Leave out sites that are farther from a face than an upper bound on its distances (4.2). Never changes a
  /// distance.
  bool bound_culling = true;
};

/// Returns the device for maps of `resolution`² texels. Throws sdm::Error if there is none or its images are
/// smaller, before a surface is built.
[[nodiscard]] SDM_API GlDevice gl_device(const GlOptions& options, std::uint32_t resolution);

/// Counters and times of the gl engine. Counts are exact and do not depend on the number of threads; a pair
/// is a site of O2 and a tile of O1, the texels of one face in a square of 16². Each pair has exactly one
/// outcome:
///   pairs = culled_by_bound + culled_by_obb + clipped_away + polygons.
struct GlReport {
  GlDevice device;
  GlClip clip = GlClip::planes;

  std::uint64_t sites = 0;          ///< of O2
  std::uint64_t sites_dropped = 0;  ///< whose region of influence has no interior; in no pair
  std::uint64_t faces = 0;          ///< of O1 that own a texel
  std::uint64_t tiles = 0;          ///< of those faces
  std::uint64_t pairs = 0;          ///< (sites − sites_dropped) × tiles
  /// Site or group of sites against a node of O1's tree. Without bound_culling all nodes have one bound:
  /// max_distance, or what no distance exceeds.
  std::uint64_t bound_tests = 0;
  std::uint64_t obb_tests = 0;  ///< region's oriented box against a node of O1's tree
  std::uint64_t culled_by_bound = 0;
  std::uint64_t culled_by_obb = 0;
  std::uint64_t clipped_away = 0;  ///< region does not meet the tile
  std::uint64_t polygons = 0;      ///< drawn
  std::uint64_t fragments = 0;     ///< shaded and within their region; planes: and face
  std::uint64_t texels = 0;        ///< owned by a face: fragments / texels is the overdraw
  std::uint64_t batches = 0;       ///< of polygons sent to the device
  /// Texels whose site proved to be farther than the distance drawn, for which the cpu engine found the
  /// closest one: close to none unless the driver is faulty.
  std::uint64_t unconfirmed = 0;

  // GlClip::stencil, else 0. lookups = hits + misses; misses − evictions values are in use at the end.
  std::uint64_t stencil_lookups = 0;
  std::uint64_t stencil_hits = 0;
  std::uint64_t stencil_misses = 0;
  std::uint64_t stencil_evictions = 0;
  /// Of a face's texels, one an eviction, and of the buffer, one at the start.
  std::uint64_t stencil_clears = 0;

  /// Wall-clock milliseconds. The device draws while the next batch is culled and clipped.
  struct Times {
    double context = 0;    ///< device and shaders: close to 0 except for the first map of a process
    double refit = 0;      ///< affine maps, boxes of O1's tree
    double bounds = 0;     ///< upper bounds on distance
    double cull = 0;       ///< bounds, oriented boxes, clipping
    double draw = 0;       ///< upload, stencil, draw calls
    double read_back = 0;  ///< waiting for the device, reading
    double finish = 0;     ///< winners in double precision, sign
  } time_ms;
};

/// The gl engine with these options. The device is opened by the first map; at any time a process draws one
/// map. Throws sdm::Error for stencil_values out of range, or where sdm was built without OpenGL.
[[nodiscard]] SDM_API std::shared_ptr<const Engine> make_gl_engine(const GlOptions& options);

/// The report of the last map that a gl engine completed; none if it has completed no map, or for another
/// engine.
[[nodiscard]] SDM_API std::optional<GlReport> gl_report(const Engine& engine);

}  // namespace sdm
