#include "gl/polygons/site_region.h"

#include <algorithm>
#include <limits>

namespace sdm::gl {
namespace {

Vec3 get3(const float* v) {
  return {v[0], v[1], v[2]};
}

void add_wall(SiteRegion& region, const Vec3& normal, double offset) {
  region.walls[region.wall_count++] = {normal, offset};
}

// Two walls that meet at an angle α, each moved outwards by s, meet s / sin(α/2) farther out. A face with a
// corner sharper than this is closed off at both ends of its longest side, where its sharp corners are.
constexpr double kSharp = 0.5;  // sine

void add_end_planes(SiteRegion& region) {
  const auto side = [&](int k) { return region.corners[(k + 1) % 3] - region.corners[k]; };
  int longest = 0;
  for (const int k : {1, 2})
    if (squared_norm(side(k)) > squared_norm(side(longest))) longest = k;
  const Vec3 &a = region.corners[longest], &b = region.corners[(longest + 1) % 3];
  const Vec3 direction = normalized(b - a);
  const double height = norm(cross(direction, region.corners[(longest + 2) % 3] - a));
  const double second = std::max(norm(side((longest + 1) % 3)), norm(side((longest + 2) % 3)));
  if (height >= kSharp * second) return;  // the sharpest corner lies between the two longest sides
  add_wall(region, direction, dot(direction, a));
  add_wall(region, -direction, -dot(direction, b));
}

}  // namespace

Vec3 SiteRegion::vector_to_site(const Vec3& x) const {
  const auto over_face = [&] {
    return std::all_of(walls.begin(), walls.begin() + 3,
                       [&](const HalfSpace& wall) { return dot(wall.normal, x) >= wall.offset; });
  };
  if (type == SiteType::vertex || (type == SiteType::face && over_face())) return distance_vector(x);
  Vec3 closest = closest_on_segment(x, corners[0], corners[1]) - x;
  for (int k = 1; k < corner_count && type == SiteType::face; ++k)
    if (const Vec3 other = closest_on_segment(x, corners[k], corners[(k + 1) % 3]) - x;
        squared_norm(other) < squared_norm(closest))
      closest = other;
  return closest;
}

bool has_interior(const sites::FaceRegion& region) {
  return region.wall[0][3] < std::numeric_limits<float>::infinity();
}

bool has_interior(const sites::EdgeRegion& region) {
  // The walls are opposite up to the rounding of single precision: the wedge between them is narrower than
  // the distance by which walls are moved outwards.
  constexpr double kOpposite = 2e-7;
  const Vec3 a = get3(region.wall[0]), b = get3(region.wall[1]);
  return a == Vec3{} || b == Vec3{} || norm(a + b) > kOpposite;
}

bool has_interior(const sites::VertexRegion&) {
  return true;
}

SiteRegion region_of(const sites::SitesData& sites, const sites::FaceRegion& face, std::size_t index) {
  SiteRegion region;
  region.type = SiteType::face;
  region.site = region.face = sites.regions.owners[index].face;
  region.axis = get3(face.plane);
  const Triangle& t = sites.mesh.triangles[region.face];
  for (const std::uint32_t vertex : t)
    region.corners[region.corner_count++] = sites.frame.to_unit(sites.mesh.positions[vertex]);
  region.anchor = region.corners[0];
  for (const auto& wall : face.wall) add_wall(region, get3(wall), wall[3]);
  add_end_planes(region);
  region.strict_walls = region.wall_count;
  return region;
}

SiteRegion region_of(const sites::SitesData& sites, const sites::EdgeRegion& edge, std::size_t) {
  SiteRegion region;
  region.type = SiteType::edge;
  region.site = edge.edge;
  region.face = sites.face_of(SiteType::edge, edge.edge);
  region.anchor = get3(edge.start);
  region.axis = get3(edge.direction);
  region.corners = {region.anchor, region.anchor + double{edge.length} * region.axis};
  region.corner_count = 2;
  add_wall(region, region.axis, dot(region.axis, region.corners[0]));
  add_wall(region, -region.axis, -dot(region.axis, region.corners[1]));
  region.strict_walls = 2;
  Vec3 former{};
  for (const auto& wall : edge.wall) {
    const Vec3 inward = get3(wall);
    if (inward == Vec3{} || inward == former) continue;
    add_wall(region, -inward, -wall[3]);
    former = inward;
  }
  return region;
}

SiteRegion region_of(const sites::SitesData& sites, const sites::VertexRegion& vertex, std::size_t index) {
  SiteRegion region;
  region.type = SiteType::vertex;
  region.site = vertex.vertex;
  region.face = sites.face_of(SiteType::vertex, vertex.vertex);
  const auto position = [&](std::uint32_t v) { return sites.frame.to_unit(sites.mesh.positions[v]); };
  region.anchor = position(vertex.vertex);
  region.corners = {region.anchor};
  region.corner_count = 1;
  const auto& neighbours = sites.regions.places.neighbours[index];
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    const bool repeated =
        std::find(neighbours.begin(), neighbours.begin() + k, neighbours[k]) != neighbours.begin() + k;
    const Vec3 ray = normalized(position(sites.regions.vertices[neighbours[k]].vertex) - region.anchor);
    if (!repeated && ray != Vec3{}) add_wall(region, -ray, -dot(ray, region.anchor));
  }
  return region;
}

}  // namespace sdm::gl
