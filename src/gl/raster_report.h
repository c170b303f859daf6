// What the gl engine counts and times.
#pragma once

#include <sdm/gl.h>

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

namespace sdm::gl {

/// All counters and times of the gl engine, of which GlReport has those that users need by members and the
/// others by name. Counts do not depend on the number of threads. A pair is a site of O2 and a tile of O1
/// (the texels of one face in a square of 16 × 16 texels). Each pair has exactly one outcome:
///   pairs = culled_by_bound + culled_by_obb + clipped_away + polygons.
struct RasterReport {
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

/// The counters that GlReport has by name, with the names.
inline constexpr std::array kNamedCounts{std::pair{"sites", &RasterReport::sites},
                                         std::pair{"sites_dropped", &RasterReport::sites_dropped},
                                         std::pair{"faces", &RasterReport::faces},
                                         std::pair{"tiles", &RasterReport::tiles},
                                         std::pair{"pairs", &RasterReport::pairs},
                                         std::pair{"bound_tests", &RasterReport::bound_tests},
                                         std::pair{"obb_tests", &RasterReport::obb_tests},
                                         std::pair{"culled_by_bound", &RasterReport::culled_by_bound},
                                         std::pair{"culled_by_obb", &RasterReport::culled_by_obb},
                                         std::pair{"clipped_away", &RasterReport::clipped_away},
                                         std::pair{"batches", &RasterReport::batches},
                                         std::pair{"stencil_lookups", &RasterReport::stencil_lookups},
                                         std::pair{"stencil_hits", &RasterReport::stencil_hits},
                                         std::pair{"stencil_misses", &RasterReport::stencil_misses},
                                         std::pair{"stencil_evictions", &RasterReport::stencil_evictions},
                                         std::pair{"stencil_clears", &RasterReport::stencil_clears}};
/// The same of the times.
inline constexpr std::array kNamedTimes{std::pair{"context", &RasterReport::Times::context},
                                        std::pair{"refit", &RasterReport::Times::refit},
                                        std::pair{"bounds", &RasterReport::Times::bounds},
                                        std::pair{"cull", &RasterReport::Times::cull},
                                        std::pair{"draw", &RasterReport::Times::draw},
                                        std::pair{"read_back", &RasterReport::Times::read_back},
                                        std::pair{"finish", &RasterReport::Times::finish}};

/// As gl_report(), with all that is counted.
[[nodiscard]] std::optional<RasterReport> raster_report(const Engine& engine);

}  // namespace sdm::gl
