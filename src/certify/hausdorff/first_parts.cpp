#include "certify/hausdorff/first_parts.h"

#include <algorithm>
#include <cmath>

#include "certify/hausdorff/nearest_face.h"
#include "core/parallel.h"
#include "geometry/vec.h"

namespace sdm::hausdorff {
namespace {

struct Site {
  SiteType type;
  std::uint32_t site;
};

std::span<const std::uint32_t> faces_of(const sites::SitesData& b, const Site& s) {
  switch (s.type) {
    case SiteType::vertex:
      return b.vertex_faces.of(s.site);
    case SiteType::edge:
      return b.topology.edge_faces(s.site);
    default:
      return {&s.site, 1};
  }
}

bool has(const sites::SitesData& b, std::uint32_t face, const Site& s) {
  switch (s.type) {
    case SiteType::vertex:
      return std::ranges::count(b.mesh.triangles[face], s.site) > 0;
    case SiteType::edge:
      return std::ranges::count(b.topology.face_edges[face], s.site) > 0;
    default:
      return face == s.site;
  }
}

// A face that has all three sites, or kNone.
std::uint32_t common_face(const sites::SitesData& b, const std::array<Site, 3>& sites) {
  for (const std::uint32_t face : faces_of(b, sites[0]))
    if (has(b, face, sites[1]) && has(b, face, sites[2])) return face;
  return kNone;
}

// The corner of a face that is closest to p.
Site nearest_corner(const sites::SitesData& b, std::uint32_t face, const Vec3& p) {
  const Triangle& t = b.mesh.triangles[face];
  return {SiteType::vertex, *std::ranges::min_element(t, {}, [&](std::uint32_t v) {
            return squared_norm(b.mesh.positions[v] - p);
          })};
}

// Adds faces of B until the bound is at most `enough`.
void bound_face(const sites::SitesData& b, const std::array<VertexDistance, 3>& corner, double enough,
                Part& part) {
  const auto offer = [&](std::uint32_t face) {
    if (face == kNone || !part.add(b, face, 0)) return false;
    const Vec3& d = part.distances[part.count - 1];
    part.upper = std::min(part.upper, std::max({d[0], d[1], d[2]}));
    return part.upper <= enough;
  };
  // One that all three closest points lie on attains the least bound that there is.
  std::array<Site, 3> site;
  for (int i = 0; i < 3; ++i) site[i] = {corner[i].type, corner[i].site};
  if (offer(common_face(b, site))) return;
  if (part.count == 0) {
    // Where B is a variant of A, the counterpart of a face has the vertices of B near its corners.
    for (int i = 0; i < 3; ++i) site[i] = nearest_corner(b, corner[i].face, part.at[i]);
    if (offer(common_face(b, site))) return;
  }
  for (const VertexDistance& c : corner)
    if (offer(c.face)) return;
  part.bound();
}

}  // namespace

FirstParts first_parts(const Mesh& a, const sites::SitesData& b, std::span<const VertexDistance> vertices,
                       double lower, double precision) {
  constexpr std::size_t kBlock = 1 << 12;
  const std::size_t blocks = (a.triangles.size() + kBlock - 1) / kBlock;
  std::vector<FirstParts> found(blocks);
  parallel_for(blocks, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = kBlock * begin; f < std::min(kBlock * end, a.triangles.size()); ++f) {
      const Triangle& t = a.triangles[f];
      if (repeats_corner(t)) continue;
      std::array<VertexDistance, 3> corner;
      for (int i = 0; i < 3; ++i) corner[i] = vertices[t[i]];
      if (std::ranges::any_of(corner, [](const VertexDistance& d) { return d.face == kNone; })) continue;
      FirstParts& block = found[f / kBlock];
      Part part{.at = corners_of(a, static_cast<std::uint32_t>(f)), .face = static_cast<std::uint32_t>(f)};
      bound_face(b, corner, lower, part);
      if (part.upper <= lower + precision)
        block.settled = std::max(block.settled, part.upper);
      else
        block.parts.push_back(part);
    }
  });
  FirstParts all;
  for (FirstParts& block : found) {
    all.parts.insert(all.parts.end(), block.parts.begin(), block.parts.end());
    all.settled = std::max(all.settled, block.settled);
  }
  return all;
}

}  // namespace sdm::hausdorff
