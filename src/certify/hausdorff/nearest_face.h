// The distance of a point to a triangle and to the nearest face of B, with bounds that hold in spite of
// rounding.
#pragma once

#include <sdm/types.h>

#include "certify/hausdorff/matching.h"
#include "geometry/triangle.h"
#include "sites/sites_data.h"

namespace sdm::hausdorff {

/// lower ≤ distance ≤ upper; a few units in the last place of the distance and the size of the triangle
/// apart, unless this is almost a segment, or its border is closer than 1e-8 of its size.
struct FaceDistance {
  double lower = 0, upper = 0;
  Vec3 point{};  ///< of the triangle, to rounding, at most `upper` from the query
};

/// Bounds on the distance from p to a triangle of any shape, also a segment or a point.
[[nodiscard]] FaceDistance face_distance(const Vec3& p, const Corners& face);

/// The upper bound only: 0 if p is a corner.
[[nodiscard]] double upper_face_distance(const Vec3& p, const Corners& face);

/// Bounds on the distance of a point: lower ≤ d(p, B) ≤ upper.
struct NearestFace {
  std::uint32_t face = kNone;
  double lower = 0, upper = 0;
  Vec3 point{};  ///< of the face, at most `upper` from p
};

/// `start` is a face of B: the closer it is, the less of the tree is searched.
[[nodiscard]] NearestFace nearest_face(const sites::SitesData& sites, const Vec3& p, std::uint32_t start);

/// Searches only the faces that a face of A is measured to; kNone and infinite bounds if there is none.
/// `start` is one of these, or kNone.
[[nodiscard]] NearestFace nearest_face(const sites::SitesData& sites, const Vec3& p, std::uint32_t start,
                                       const Matching& matching, std::uint32_t face);

}  // namespace sdm::hausdorff
