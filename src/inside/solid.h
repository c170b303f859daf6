// The winding number of closed meshes, decided exactly.
#pragma once

#include <cmath>
#include <optional>

#include "geometry/affine.h"
#include "inside/angles/expansions.h"
#include "rays/trace.h"
#include "sites/sites_data.h"

namespace sdm::inside {

/// The winding number w(p) of a closed mesh moved by `pose`, with outward-oriented faces, from the crossings
/// of the segment from p to a point q outside the mesh: w(p) = Σ ±1, + where it leaves through a face. Empty
/// if the segment intersects an edge. Exact if p does not lie on the surface. Cost: O(log n), plus linear in
/// the faces that the segment meets.
[[nodiscard]] std::optional<int> winding(const sites::SitesData& sites, const Affine& pose, const Vec3& p,
                                         const Vec3& q);

/// The signed crossings of the segment from p to q with faces moved by `pose`: Σ ±1, + where it leaves
/// through the outer side of a face. Equal to w(p) − w(q) for the faces of a closed mesh. Empty, exact and of
/// the same cost as winding().
[[nodiscard]] std::optional<int> crossings(const OrientedFaces& faces, const Affine& pose, const Vec3& p,
                                           const Vec3& q);
/// The signed crossings of a part of a segment with the faces of unmoved sites: exact, empty where the part
/// meets an edge. Boxes of the wide tree are tested eight at a time. `near`: the nodes that meet a box which
/// contains the part, or null.
[[nodiscard]] std::optional<int> crossings(const sites::SitesData& sites, const rays::Segment& segment,
                                           const rays::NearNodes* near = nullptr);

/// The winding number around a point: crossings(q) of the first segment for which it is set, of at most
/// `most` segments to points q outside the box of the tree, moved by `pose`. 0 if the point is outside the
/// box; empty if there is no such segment.
template <class Crossings>
[[nodiscard]] std::optional<int> winding_by_segments(const FaceTree& faces, const Affine& pose,
                                                     const Vec3& point, int most, const Crossings& crossings);

/// The winding number of a solid moved by `pose` around a point that does not lie on its surface: 0 outside.
/// Exact; 0 for a point on an edge. Cost: usually that of one segment.
[[nodiscard]] int winding(const sites::SitesData& solid, const Affine& pose, const Vec3& point);
/// winding() of a solid that is not moved, in a fraction of the time.
[[nodiscard]] int winding(const sites::SitesData& solid, const Vec3& point);

/// Whether a solid moved by `pose` contains a point that does not lie on its surface: whether its winding
/// number around the point is not 0.
[[nodiscard]] inline bool contains(const sites::SitesData& solid, const Affine& pose, const Vec3& point) {
  return winding(solid, pose, point) != 0;
}
[[nodiscard]] inline bool contains(const sites::SitesData& solid, const Vec3& point) {
  return winding(solid, point) != 0;
}

template <class Crossings>
std::optional<int> winding_by_segments(const FaceTree& faces, const Affine& pose, const Vec3& point, int most,
                                       const Crossings& crossings) {
  constexpr double kMargin = 1e-9;  // of the unit frame, far above rounding
  // The shortest way out of the box is along one of the axes of the frame.
  const tree::FloatBox& box = faces.tree.box(0);
  const Vec3 p = faces.frame.to_unit(inverse(pose)(point));
  int axis = 0;
  double way = kInfinity;
  bool up = false;
  for (int k = 0; k < 3; ++k) {
    const double below = p[k] - box.lower[k], above = box.upper[k] - p[k];
    if (below < -kMargin || above < -kMargin) return 0;
    if (below < way) {
      way = below;
      axis = k;
      up = false;
    }
    if (above < way) {
      way = above;
      axis = k;
      up = true;
    }
  }
  const double length = (up ? 1 : -1) * (std::abs(way) + 0.01) / faces.frame.scale;
  // Segments along (1, t, t²) that intersect an edge are skipped. Those that meet the same edge lie in one
  // plane through the point, and no such plane contains more than two of them, so that only points on an edge
  // need more than a few.
  double t = 0.0137035999;
  for (int i = 0; i < most; ++i, t += 0.0072973525) {
    Vec3 along;
    along[axis] = length;
    along[(axis + 1) % 3] = t * length;
    along[(axis + 2) % 3] = t * t * length;
    if (const std::optional<int> turns = crossings(point + pose.linear(along))) return turns;
  }
  return {};
}

}  // namespace sdm::inside
