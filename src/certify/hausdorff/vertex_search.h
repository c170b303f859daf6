// Distances from the vertices of A near which the largest distance may occur.
#pragma once

#include <sdm/progress.h>

#include <span>
#include <vector>

#include "certify/hausdorff/lower_bound.h"
#include "sites/sites_data.h"

namespace sdm::hausdorff {

/// Whether a face of A is ignored, as Sites ignores it.
[[nodiscard]] constexpr bool repeats_corner(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// A face of B that is closest to a vertex up to the precision of the cpu engine, and the distance to it,
/// rounded upwards.
struct VertexDistance {
  double upper = std::numeric_limits<double>::infinity();
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
