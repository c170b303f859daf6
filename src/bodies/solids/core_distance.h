// The signed distance of two convex cores.
#pragma once

#include "bodies/convex/difference_hull.h"
#include "bodies/solids/posed_core.h"

namespace sdm::solids {

/// The closest points of two cores that are apart, or the shortest way out of two that overlap: moving the
/// first by −distance · normal makes them touch.
struct CoreDistance {
  double distance = 0;       ///< negative if the cores overlap
  double error = 0;          ///< the true distance is at most that far from it
  Vec3 normal{};             ///< of length 1, from the second to the first if they are apart
  Vec3 point1{}, point2{};   ///< point1 − point2 = distance · normal, to rounding
  bool overlapping = false;  ///< whether the cores certainly have a point inside both
};

/// Finds the closest points of two cores, neither a half-space: by the algorithm of Gilbert, Johnson and
/// Keerthi; 0 if they overlap, without a normal. Cost: some steps, each that of two support functions.
[[nodiscard]] CoreDistance core_gap(const PosedCore& a, const PosedCore& b);

/// The signed distance of a point from an axis, in closed form.
[[nodiscard]] CoreDistance point_to_axis(const Vec3& point, const PosedCore& axis);

/// The signed distance where it is known without the hull of the difference: in closed form, or of cores that
/// are reliably apart. `size`: of both bodies.
struct QuickDistance : CoreDistance {
  bool known = false;  ///< otherwise, all but `overlapping` may be wrong
};
[[nodiscard]] QuickDistance quick_distance(const PosedCore& a, const PosedCore& b, double size);

/// The signed distance: quick_distance(), or that of the hull of the difference.
[[nodiscard]] CoreDistance core_distance(const PosedCore& a, const PosedCore& b, double size,
                                         convex::ExitWorkspace& workspace);
/// The same, if quick_distance() is `quick`.
[[nodiscard]] CoreDistance core_distance(const PosedCore& a, const PosedCore& b, double size,
                                         const QuickDistance& quick, convex::ExitWorkspace& workspace);

}  // namespace sdm::solids
