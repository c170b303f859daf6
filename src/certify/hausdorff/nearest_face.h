// The face of B that is closest to a point, in double precision, with bounds that hold in spite of rounding.
#pragma once

#include "certify/hausdorff/matching.h"
#include "geometry/triangle.h"
#include "sites/sites_data.h"

namespace sdm::hausdorff {

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
