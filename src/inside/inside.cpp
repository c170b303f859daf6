#include "inside/inside.h"

#include <algorithm>
#include <string>

#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "inside/crossings/ray_parity.h"

namespace sdm::inside {

InsideTest::InsideTest(const sites::SitesData& sites, SignMethod method)
    : sites_(sites), method_(method), box_(bounds(sites.mesh)) {
  if (method == SignMethod::winding) winding_.emplace(sites);
  has_slivers_ = std::ranges::find(sites.sliver, 1) != sites.sliver.end();
}

bool InsideTest::beside_sliver(const ClosestPoint& c) const {
  if (!has_slivers_) return false;
  const auto is_sliver = [&](std::uint32_t face) { return sites_.sliver[face] != 0; };
  if (c.type == SiteType::edge) return std::ranges::any_of(sites_.topology.edge_faces(c.site), is_sliver);
  if (c.type == SiteType::vertex) return std::ranges::any_of(sites_.vertex_faces.of(c.site), is_sliver);
  return is_sliver(c.face);
}

bool InsideTest::operator()(const Vec3& query, const ClosestPoint& closest) const {
  switch (method_) {
    case SignMethod::pseudonormal:
      if (closest.type == SiteType::none || !sdm::contains(box_, query)) return false;
      if (beside_sliver(closest))
        return closest.distance > 0 && odd_crossings(sites_.face_tree(), sites_.frame.to_unit(query));
      return dot(query - closest.point, sites::pseudonormal(sites_.normals, sites_.topology, closest)) < 0;
    case SignMethod::winding:
      return (*winding_)(query) > 0.5;
    default:
      return false;
  }
}

std::uint32_t InsideTest::operator()(std::span<const Vec3> queries,
                                     const sites::ClosestPacket& closest) const {
  std::uint32_t inside = 0;
  if (method_ == SignMethod::none) return inside;
  const bool in_box = method_ == SignMethod::pseudonormal;  // the box alone decides most queries
  for (std::size_t i = 0; i < closest.count; ++i)
    if (!in_box || sdm::contains(box_, queries[i]))
      inside |= static_cast<std::uint32_t>((*this)(queries[i], closest.get(i, queries[i]))) << i;
  return inside;
}

}  // namespace sdm::inside
