// The shortest way out of the difference of two convex bodies.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "bodies/convex/simplex_point.h"
#include "bodies/convex/support_search.h"

namespace sdm::convex {

/// The point of the difference that is farthest along u, |u| = 1: of a point of O1 with the largest u·x, and
/// one of O2 with the least. `near`: the vertices of a similar direction, which may make it shorter to find
/// them; kNone where they are not known, also of the result.
using Support = std::function<SimplexPoint(const Vec3& u, const std::array<std::uint32_t, 2>& near)>;

/// Moving O1 by −upper · direction separates the convex hulls of both bodies; nothing shorter than `lower`
/// does.
struct ConvexExit {
  double lower = 0, upper = 0;
  Vec3 direction{};
  Simplex touching{};  ///< the vertices between which they touch then, if known, without a direction
};

/// Memory that searches reuse; results do not depend on it.
struct ExitWorkspace {
  /// A point of the difference, rounded to a fine grid.
  struct Point : SimplexPoint {
    std::array<std::int64_t, 3> grid{};
    double distance = 0;  ///< from the origin
  };
  struct Facet {
    std::array<std::uint32_t, 3> corner{};
    std::array<std::uint32_t, 3> across{};  ///< the face beyond the side from corner i to corner i + 1
    Vec3 normal{};                          ///< not normalised
    double doubt = 0;                       ///< what heights along it are larger than if their sign is known
    double least = 0;      ///< a lower bound on its distance from the origin, negative if that is beyond it
    bool reliable = true;  ///< the normal; false for slivers
    bool removed = false;
  };
  std::vector<Point> points;
  std::vector<Facet> facets;
  std::vector<std::pair<double, std::uint32_t>> order;           ///< a heap, the nearest face first
  std::vector<std::pair<std::uint32_t, std::uint32_t>> horizon;  ///< faces that stay, and their sides
  std::vector<std::uint32_t> open;
  std::vector<std::uint32_t> from;  ///< of a corner of the horizon, the new face whose side begins there
};

/// The hulls overlap after all translations inside of their difference, so the exit is the least height
/// h(u) = max of u·(x1 − x2) over all directions u. A polytope of points of the difference is expanded at its
/// face nearest to the origin (van den Bergen 2001): its distance bounds h from below, and h of its normal
/// from above. Points are rounded to a grid, by 2e-12 · size, on which it is decided exactly which faces a
/// new one sees, so that the polytope is the hull of its points however flat it is. Bounds differ by at most
/// 1e-10 · size, unless the difference has tens of thousands of faces that are equally near. `first`: a unit
/// vector along which the exit may be, or 0. `size`: of both bodies, whose points differ by no more. The
/// upper bound is negative if the hulls are apart.
[[nodiscard]] ConvexExit exit_of_hulls(const Support& support, const Vec3& first, double size,
                                       ExitWorkspace& workspace);

}  // namespace sdm::convex
