// The distance b(p) from a point inside a solid to the boundary of the solid.
#pragma once

#include <sdm/closest_points.h>

#include <optional>

#include "bodies/shape/body.h"
#include "certify/depth/boundary_part.h"

namespace sdm::depth {

struct BoundaryDistance {
  double lower = 0, upper = 0;  ///< bounds: those of a solid that intersects itself may differ
  double value = 0;             ///< the distance of `point`, if known
  std::optional<Vec3> point{};  ///< of the boundary
  std::optional<BoundaryPart> nearest{};
};

/// The distance to the boundary of a point inside, given its closest point on the surface of the solid.
[[nodiscard]] BoundaryDistance boundary_distance(const shape::Body& solid, const Vec3& p,
                                                 const ClosestPoint& closest);
/// The same by the division of the faces that others intersect, also for points that are not inside.
[[nodiscard]] BoundaryDistance distance_to_boundary(const shape::Body& solid, const Vec3& p);
/// A face with that closest point which is boundary on one side everywhere, if there is one.
[[nodiscard]] std::optional<BoundaryPart> boundary_face(const shape::Body& solid,
                                                        const ClosestPoint& closest);

/// Bounds b at the points p inside the solid of a triangle with the point c, which is outside. The way in the
/// triangle from c to p passes through some face, at x, so b(p) ≤ |p − x|. As c and p are on different sides
/// of its plane, |p − x| is the part of |p − c| that is beyond the plane. A triangle that no face intersects
/// has no point inside. `triangle` is in the ball about c; stops at `most`.
[[nodiscard]] double bound_beyond_faces(const sites::SitesData& solid, const Corners& triangle,
                                        const shape::Ball& ball, double most);

}  // namespace sdm::depth
