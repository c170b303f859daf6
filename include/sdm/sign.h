/// Inside or outside of O2: the sign of a distance.
#pragma once

#include <sdm/api.h>
#include <sdm/sites.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sdm {

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

/// The sign method that compute_map uses for `asked`, with its reason. Throws sdm::Error where O2 does not
/// allow it.
[[nodiscard]] SDM_API SignUsed choose_sign(const Sites& sites, SignMethod asked);

/// For each closest point: whether its query lies inside O2 (1) or not (0), by `method` (pseudonormal or
/// winding, else none is). `closest` comes from closest_points with the same sites; where it has no site, the
/// answer of pseudonormal is 0. Throws sdm::Error for a method that O2 does not allow.
[[nodiscard]] SDM_API std::vector<std::uint8_t> inside_flags(const Sites& sites,
                                                             std::span<const Vec3> queries,
                                                             std::span<const ClosestPoint> closest,
                                                             SignMethod method);

}  // namespace sdm
