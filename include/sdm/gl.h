/// The gl engine: surface distance maps by rasterisation on OpenGL (Sud et al. 2006): options and report.
///
/// Threads: all functions may be called concurrently; an engine may serve several threads at once.
#pragma once

#include <sdm/engine.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace sdm {

/// A device that supports OpenGL 4.5.
struct GlDevice {
  std::string name;    ///< the driver's GL_RENDERER
  std::string driver;  ///< its GL_VERSION
  bool software = false;
};

template <>
inline constexpr std::tuple kFields<GlDevice>{
    Field{"name", &GlDevice::name, "The driver's GL_RENDERER."},
    Field{"driver", &GlDevice::driver, "Its GL_VERSION."},
    Field{"software", &GlDevice::software, "Whether it draws on the processor."}};

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

/// What the last map of a gl engine took. Counts do not depend on the number of threads.
struct GlReport {
  GlDevice device;
  GlClip clip = GlClip::planes;
  std::uint64_t polygons = 0;   ///< drawn
  std::uint64_t fragments = 0;  ///< shaded, and inside the region of their site (planes: and face)
  std::uint64_t texels = 0;     ///< owned by a face: fragments / texels is the overdraw
  /// Texels whose site is farther than the distance drawn; their closest site is recomputed by the cpu
  /// engine. 0 unless the driver is faulty.
  std::uint64_t unconfirmed = 0;
  /// What else the engine counts, and the wall-clock milliseconds of its stages, by the names that the
  /// section on `raster` in docs/report.md explains. They are those of its algorithm, and may change with it.
  std::vector<std::pair<std::string_view, std::uint64_t>> counts{};
  std::vector<std::pair<std::string_view, double>> time_ms{};

  /// Fragments per texel; 0 without texels.
  [[nodiscard]] double overdraw() const {
    return texels == 0 ? 0 : static_cast<double>(fragments) / static_cast<double>(texels);
  }
};

template <>
inline constexpr std::tuple kFields<GlReport>{
    Field{"device", &GlReport::device, "The device."},
    Field{"clip", &GlReport::clip, "How polygons were clipped."},
    Field{"polygons", &GlReport::polygons, "Polygons of sites that were drawn."},
    Field{"fragments", &GlReport::fragments, "Fragments that were shaded, and are inside their region."},
    Field{"texels", &GlReport::texels, "The texels that a face owns."},
    Field{"unconfirmed", &GlReport::unconfirmed,
          "Texels whose site is farther than the distance drawn: 0 unless the driver is faulty."}};

/// Returns a gl engine with these options. The first map opens the device; a process draws one map at a time.
/// Throws sdm::Error for stencil_values out of range, or if sdm was built without OpenGL.
[[nodiscard]] SDM_API std::shared_ptr<const Engine> make_gl_engine(const GlOptions& options);

/// Returns the report of the last map that a gl engine completed; empty if it has not completed one, or for
/// any other engine.
[[nodiscard]] SDM_API std::optional<GlReport> gl_report(const Engine& engine);

}  // namespace sdm
