/// The surface distance map: at every texel of O1's atlas, the distance to O2.
#pragma once

#include <sdm/progress.h>
#include <sdm/gl.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sdm {

enum class EngineKind {
  cpu,        ///< lists of sites for groups of texels, SIMD, all cores
  reference,  ///< scalar, double, plain: the oracle
  gl,         ///< the paper's: polygons of sites rasterised by OpenGL; maps only
};

/// How the inside of O2 is told from the outside. Negative means inside.
enum class SignMethod {
  automatic,     ///< pseudonormal where O2 is closed and orientable, else none
  none,          ///< unsigned distances
  pseudonormal,  ///< the closest site's angle-weighted pseudonormal (Bærentzen & Aanæs 2005); for closed O2,
                 ///< exact but at walls thinner than 1e-7 of the distance to them
  winding,  ///< generalised winding number above 1/2 (Jacobson et al. 2013): an estimate for open O2
};

/// The method that was used, and why, in words for a report.
struct SignUsed {
  SignMethod method = SignMethod::none;
  std::string reason;
};

struct MapOptions {
  EngineKind engine = EngineKind::cpu;
  SignMethod sign = SignMethod::automatic;
  /// Greater than 0, in units of the meshes. Texels farther than this hold no value (NaN).
  double max_distance = std::numeric_limits<double>::infinity();
  GlOptions raster{};  ///< for EngineKind::gl
  Progress progress{};
};

/// One value a texel, row 0 at the top, in arrays of resolution². Where there is none, because no face owns
/// the texel or O2 is farther than max_distance: NaN, kNone and SiteType::none.
struct DistanceMap {
  std::uint32_t resolution = 0;
  std::vector<float> distance;      ///< |vector|, negative inside O2 if signed
  std::vector<Vec3f> vector;        ///< closest point of O2 − texel's surface point
  std::vector<std::uint32_t> site;  ///< index of the closest site among those of its type
  std::vector<SiteType> site_type;
  SignUsed sign;
  std::size_t beyond_max_distance = 0;  ///< owned texels without a value
  std::optional<GlReport> raster;   ///< of EngineKind::gl
};

/// Computes the map. Distance and vector are those of a site found exactly (cpu: to 1e-6 of the diagonal of
/// both meshes; gl: to 2e-6; reference: to double rounding), evaluated in double and stored in float. Throws
/// sdm::Error for a sign method that O2 does not allow, or for want of memory; Cancelled.
[[nodiscard]] DistanceMap compute_map(const Surface& surface, const Sites& sites,
                                      const MapOptions& options = {});

/// The same into `map`, in the memory that it has where that suffices: for one frame after another. If it
/// throws, the map's values are unspecified.
void compute_map(const Surface& surface, const Sites& sites, const MapOptions& options, DistanceMap& map);

/// Closest points of O2 to any points, in any order, by the same engines. `distance` in the result is
/// unsigned; options.sign is not used. Throws sdm::Error for a coordinate that is NaN or beyond 1e37;
/// Cancelled.
[[nodiscard]] std::vector<ClosestPoint> closest_points(const Sites& sites, std::span<const Vec3> points,
                                                       const MapOptions& options = {});

/// The sign method that compute_map uses for `asked`, with its reason. Throws sdm::Error where O2 does not
/// allow it.
[[nodiscard]] SignUsed choose_sign(const Sites& sites, SignMethod asked);

/// For each closest point: whether its query lies inside O2 (1) or not (0), by `method` (pseudonormal or
/// winding, else none is). `closest` comes from closest_points with the same sites; where it has no site, the
/// answer of pseudonormal is 0. Throws sdm::Error for a method that O2 does not allow.
[[nodiscard]] std::vector<std::uint8_t> inside(const Sites& sites, std::span<const Vec3> queries,
                                               std::span<const ClosestPoint> closest, SignMethod method);

}  // namespace sdm
