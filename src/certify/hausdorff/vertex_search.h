// The largest distance that is known to occur, and distances from the vertices of A near which it may be
// larger.
#pragma once

#include <sdm/execution.h>

#include <algorithm>
#include <vector>

#include "certify/hausdorff/nearest_face.h"
#include "certify/hausdorff/side.h"
#include "sites/sites_data.h"

namespace sdm::hausdorff {

/// A point of A with the distance to B there.
struct LowerBound {
  double value = -1;        ///< ≤ the largest distance
  Vec3 point{}, closest{};  ///< of A and of B
  std::array<std::uint32_t, 2> faces{kNone, kNone};
  const Side* side = nullptr;  ///< null: points on both sides of B count

  void raise(const LowerBound& other) {
    if (other.value > value) *this = other;
  }
  /// `point` is a point of a face of A, at most `rounding` from it.
  void raise(const Vec3& p, double rounding, std::uint32_t face, const NearestFace& nearest) {
    const double distance = std::max(0.0, nearest.lower - rounding);
    if (distance > value && (side == nullptr || side->has(p, nearest.upper)))
      *this = {distance, p, nearest.point, {face, nearest.face}, side};
  }
};

/// Whether a face of A is ignored, as Sites ignores it.
[[nodiscard]] constexpr bool repeats_corner(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// A face of B that is closest to a vertex up to the precision of the cpu engine, and the distance to it,
/// rounded upwards.
struct VertexDistance {
  double upper = kInfinity;
  std::uint32_t face =
      kNone;  ///< kNone: not computed, as no face of A at the vertex is above the lower bound
  std::uint32_t site = kNone;
  SiteType type = SiteType::none;
};

/// Returns the distances of the vertices of A, and raises the lower bound. Vertices are grouped in space;
/// first one of each group is measured, then the groups whose faces may exceed the lower bound are divided:
/// far from its maximum the distance is never computed, while near it all vertices are measured in batches.
[[nodiscard]] std::vector<VertexDistance> search_vertices(const Mesh& a, const sites::SitesData& b,
                                                          const Progress& progress, LowerBound& lower);

}  // namespace sdm::hausdorff
