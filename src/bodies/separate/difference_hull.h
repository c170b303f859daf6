// The shortest way out of the difference of two convex bodies.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "geometry/vec.h"

namespace sdm::separate {

/// A vertex of O1 and one of O2; kNone if they are not known.
using VertexPair = std::array<std::uint32_t, 2>;
inline constexpr VertexPair kNoVertices{kNone, kNone};

/// Support points in the direction u, |u| = 1: a point of O1 with the largest u·x, and one of O2 with the
/// least. `near`: those of a similar direction, which may make it shorter to find them.
struct SupportPair {
  Vec3 x1{}, x2{};
  VertexPair vertices = kNoVertices;
  [[nodiscard]] Vec3 difference() const { return x1 - x2; }
};
using Support = std::function<SupportPair(const Vec3& u, const VertexPair& near)>;

/// Moving O1 by −upper · direction separates the convex hulls of both bodies; nothing shorter than `lower`
/// does.
struct ConvexExit {
  double lower = 0, upper = 0;
  Vec3 direction{};
  std::array<VertexPair, 3> vertices{kNoVertices, kNoVertices,
                                     kNoVertices};  ///< between which they touch then
};

/// Memory that searches reuse; results do not depend on it.
struct ExitWorkspace {
  /// A point of a grid, so fine that it is one of the difference, to rounding.
  struct Point {
    Vec3 at{};
    std::array<std::int64_t, 3> grid{};
    double distance = 0;  ///< from the origin
    VertexPair vertices{};
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

}  // namespace sdm::separate
