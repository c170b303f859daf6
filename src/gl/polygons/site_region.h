// A site of O2 with its region of influence and the distance vector to it, which is affine there (Lemma 1).
#pragma once

#include <sdm/sites.h>

#include <array>

#include "geometry/vec.h"
#include "sites/sites_data.h"

namespace sdm::gl {

/// The half-space normal·x ≥ offset.
struct HalfSpace {
  Vec3 normal{};
  double offset = 0;
};

/// All coordinates are in the unit frame of O2. The region is the intersection of the walls; see
/// sites/regions.h.
struct SiteRegion {
  static constexpr int kMostWalls = 5;

  SiteType type = SiteType::none;
  std::uint32_t site = kNone;  ///< its index among those of its type
  std::uint32_t face = kNone;  ///< a face to which the site belongs
  Vec3 anchor{};               ///< a point of the site's plane or line, or the vertex itself
  Vec3 axis{};                 ///< face: its normal; edge: its direction; vertex: none
  std::array<Vec3, 3> corners{};
  int corner_count = 0;
  std::array<HalfSpace, kMostWalls> walls{};
  int wall_count = 0;
  /// The number of leading walls beyond which the affine vector is too short to be the distance vector.
  int strict_walls = 0;

  /// The linear part of x ↦ closest point − x.
  [[nodiscard]] Vec3 change(const Vec3& dx) const {
    switch (type) {
      case SiteType::face:
        return -dot(axis, dx) * axis;
      case SiteType::edge:
        return dot(axis, dx) * axis - dx;
      default:
        return -dx;
    }
  }
  [[nodiscard]] Vec3 distance_vector(const Vec3& x) const { return change(x - anchor); }
  /// The vector from any x to the closest point of the closed site: affine only where it is
  /// distance_vector().
  [[nodiscard]] Vec3 vector_to_site(const Vec3& x) const;
  [[nodiscard]] Box box() const {
    Box b;
    for (int k = 0; k < corner_count; ++k) extend(b, corners[k]);
    return b;
  }
};

/// Whether the region has an interior. A face too thin for its walls has none, nor does an edge whose two
/// faces are coplanar: the sites around them contain all closest points.
[[nodiscard]] bool has_interior(const sites::FaceRegion& region);
[[nodiscard]] bool has_interior(const sites::EdgeRegion& region);
[[nodiscard]] bool has_interior(const sites::VertexRegion& region);

/// The region of the face, edge or vertex at an index of regions.faces, edges or vertices.
[[nodiscard]] SiteRegion region_of(const sites::SitesData& sites, const sites::FaceRegion& region,
                                   std::size_t index);
[[nodiscard]] SiteRegion region_of(const sites::SitesData& sites, const sites::EdgeRegion& region,
                                   std::size_t index);
[[nodiscard]] SiteRegion region_of(const sites::SitesData& sites, const sites::VertexRegion& region,
                                   std::size_t index);

/// Calls visit(region, index) for every site of a leaf of O2's tree.
template <class Visit>
void for_each_site(const sites::Regions& regions, std::size_t leaf, Visit&& visit) {
  const std::uint32_t begin = regions.leaves[leaf], end = regions.leaves[leaf + 1];
  const sites::Regions::Owner &first = regions.owners[begin], &last = regions.owners[end];
  for (std::size_t i = begin; i < end; ++i) visit(regions.faces[i], i);
  for (std::size_t i = first.edges; i < last.edges; ++i) visit(regions.edges[i], i);
  for (std::size_t i = first.vertices; i < last.vertices; ++i) visit(regions.vertices[i], i);
}

}  // namespace sdm::gl
