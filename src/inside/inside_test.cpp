#include "inside/inside_test.h"

#include <sdm/error.h>

#include <algorithm>
#include <string>

#include "core/parallel.h"
#include "core/vec.h"
#include "inside/crossings/ray_parity.h"

namespace sdm {
namespace {

// Why O2 has no inside, as a clause, or nothing if it has one.
std::string open_reason(const SitesData& sites) {
  std::size_t boundary = 0, nonmanifold = 0;
  for (std::size_t e = 0; e < sites.topology.edges.size(); ++e) {
    boundary += sites.topology.edge_faces(e).size() == 1;
    nonmanifold += sites.topology.edge_faces(e).size() > 2;
  }
  if (boundary > 0) return "O2 is open (" + std::to_string(boundary) + " boundary edges)";
  if (nonmanifold > 0)
    return "O2 is not manifold (" + std::to_string(nonmanifold) + " edges of more than two faces)";
  if (!sites.orientation.orientable) return "O2 is not orientable";
  return {};
}

Vec3 pseudonormal(const SitesData& sites, const ClosestPoint& c) {
  switch (c.type) {
    case SiteType::vertex:
      return sites.normals.vertex[c.site];
    case SiteType::edge:
      return edge_pseudonormal(sites.normals, sites.topology, c.site);
    default:
      return sites.normals.face[c.face];
  }
}

}  // namespace

SignUsed choose_sign(const Sites& sites, SignMethod asked) {
  const std::string open = open_reason(sites.impl());
  switch (asked) {
    case SignMethod::none:
      return {SignMethod::none, "asked for"};
    case SignMethod::winding:
      return {SignMethod::winding, open.empty() ? "asked for; O2 is closed and orientable"
                                                : "asked for; an estimate, because " + open};
    case SignMethod::pseudonormal:
      if (!open.empty())
        throw Error("distances cannot be signed by pseudonormals: " + open +
                    "; take sign none, or winding for an estimate");
      return {SignMethod::pseudonormal, "asked for; O2 is closed and orientable"};
    case SignMethod::automatic:
      break;
  }
  if (!open.empty()) return {SignMethod::none, open};
  return {SignMethod::pseudonormal, "O2 is closed and orientable"};
}

InsideTest::InsideTest(const SitesData& sites, SignMethod method)
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
      if (closest.type == SiteType::none || !contains(box_, query)) return false;
      if (beside_sliver(closest))
        return closest.distance > 0 &&
               odd_crossings(sites_.mesh.positions, sites_.frame, sites_.mesh.triangles, sites_.tree,
                             sites_.frame.to_unit(query));
      return dot(query - closest.point, pseudonormal(sites_, closest)) < 0;
    case SignMethod::winding:
      return (*winding_)(query) > 0.5;
    default:
      return false;
  }
}

std::uint32_t InsideTest::operator()(std::span<const Vec3> queries, const ClosestPacket& closest) const {
  std::uint32_t inside = 0;
  if (method_ == SignMethod::none) return inside;
  const bool in_box = method_ == SignMethod::pseudonormal;  // most queries are told by it alone
  for (std::size_t i = 0; i < closest.count; ++i)
    if (!in_box || contains(box_, queries[i]))
      inside |= static_cast<std::uint32_t>((*this)(queries[i], closest.get(i, queries[i]))) << i;
  return inside;
}

std::vector<std::uint8_t> inside(const Sites& sites, std::span<const Vec3> queries,
                                 std::span<const ClosestPoint> closest, SignMethod method) {
  if (queries.size() != closest.size()) throw Error("inside() needs one closest point for each query");
  const InsideTest test(sites.impl(), choose_sign(sites, method).method);
  std::vector<std::uint8_t> result(queries.size());
  parallel_for(queries.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = test(queries[i], closest[i]);
  });
  return result;
}

}  // namespace sdm
