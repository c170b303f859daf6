/// Inside or outside of O2: the sign of a distance.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/names.h>
#include <sdm/sites.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

/// How inside and outside of O2 are distinguished. Negative distances are inside.
enum class SignMethod {
  automatic,  ///< exact where O2 is closed and orientable, else none
  none,       ///< unsigned distances
  /// Inside of a closed, orientable O2 are the points with a winding number other than 0, with all shells
  /// oriented outwards, whether O2 intersects itself or not. A shell is a cavity if it lies inside an odd
  /// number of other shells that it neither touches nor intersects, otherwise a solid. Exact at points
  /// farther from O2 than 1e-6 of the diagonal of the scene.
  exact,
  /// The same as exact for closed, orientable O2. Inside of any other O2 are the points with a generalised
  /// winding number above 1/2 (Jacobson et al. 2013), decided to rounding; an estimate of insideness.
  winding,
  /// The same as exact for closed, orientable O2. Behind any other orientable O2 (negative) are the points on
  /// the side to which its normals do not point: with c the closest point and n the pseudonormal of the site
  /// that c lies on, q is behind where (q − c)·n < 0. Normals are those of most faces of each component.
  /// Points whose closest site is a boundary edge of O2, or a vertex of one, have no side and keep distances
  /// ≥ 0; boundary_mask() marks them. An estimate: the sign changes where no distance is 0, beyond the
  /// boundary.
  side,
};

template <>
inline constexpr std::array kWords<SignMethod>{"automatic", "none", "exact", "winding", "side"};

/// Whether a method estimates signs: between samples a distance may have the other sign.
[[nodiscard]] constexpr bool is_estimate(SignMethod method) {
  return method == SignMethod::winding || method == SignMethod::side;
}

/// The method that was used, and the reason in words, for reports.
struct SignUsed {
  SignMethod method = SignMethod::none;
  std::string reason;
};

template <>
inline constexpr std::tuple kFields<SignUsed>{Field{"method", &SignUsed::method, "The method that was used."},
                                              Field{"reason", &SignUsed::reason, "Why, in words."}};

/// Returns the sign method that compute_map uses for `asked`, with the reason. Throws sdm::Error if O2 does
/// not allow it.
[[nodiscard]] SDM_API SignUsed choose_sign(const Sites& sites, SignMethod asked);

/// Returns, for each query, whether it lies inside O2 (1) or not (0) according to `method`; all are 0 if no
/// method is used. `closest` are the closest points of the queries, from closest_points with the same sites;
/// exact returns 0 where there is no site, and points on the boundary of the solid are not inside. What the
/// method needs is kept with the sites until they change: the first call makes it, in O(n log n). Throws
/// sdm::Error for a method that O2 does not allow, for a query with a coordinate that is NaN or beyond 1e37,
/// if the numbers of queries and closest points differ, or if there is not enough memory.
[[nodiscard]] SDM_API std::vector<std::uint8_t> inside_flags(const Sites& sites,
                                                             std::span<const Vec3> queries,
                                                             std::span<const ClosestPoint> closest,
                                                             SignMethod method);

}  // namespace sdm
