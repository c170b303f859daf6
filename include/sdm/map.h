/// The surface distance map: at every texel of O1's atlas, the distance to O2.
#pragma once

#include <sdm/api.h>
#include <sdm/engine.h>
#include <sdm/progress.h>
#include <sdm/sign.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sdm {

struct MapOptions {
  std::shared_ptr<const Engine> engine{};  ///< null: the cpu engine
  SignMethod sign = SignMethod::automatic;
  /// Greater than 0, in units of the meshes. Texels farther than this have no value (NaN).
  double max_distance = std::numeric_limits<double>::infinity();
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
};

/// Computes the map. Distance and vector are those of a site found exactly (cpu: to 1e-6 of the diagonal of
/// both meshes; gl: to 2e-6; reference: to double rounding), evaluated in double and stored in float. Throws
/// sdm::Error for a sign method that O2 does not allow, for a max_distance that is not positive, if the
/// engine fails, or for want of memory; Cancelled.
[[nodiscard]] SDM_API DistanceMap compute_map(const Surface& surface, const Sites& sites,
                                              const MapOptions& options = {});

/// Writes into `map`, reusing its memory where possible: for sequences of frames. If it
/// throws, the map's values are unspecified.
SDM_API void compute_map(const Surface& surface, const Sites& sites, const MapOptions& options,
                         DistanceMap& map);

}  // namespace sdm
