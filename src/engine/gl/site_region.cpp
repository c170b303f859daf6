#include "engine/gl/site_region.h"

#include <algorithm>
#include <limits>

namespace sdm::gl {
namespace {

constexpr int kWidth = RegionBlock::kWidth;

Vec3 get3(const float (&rows)[3][kWidth], int lane) {
  return {rows[0][lane], rows[1][lane], rows[2][lane]};
}
Vec3 normal_of(const float (&rows)[4][kWidth], int lane) {
  return {rows[0][lane], rows[1][lane], rows[2][lane]};
}

void add_wall(SiteRegion& region, const Vec3& normal, double offset) {
  region.walls[region.wall_count++] = {normal, offset};
}

// Two walls that meet at an angle α, each moved outwards by s, meet s / sin(α/2) farther out. A face with a
// sharper corner than this is closed off at both ends of its longest side, where its sharp corners are.
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

bool has_interior(const FaceBlock& block, int lane) {
  return block.wall[0][3][lane] < std::numeric_limits<float>::infinity();
}

bool has_interior(const EdgeBlock& block, int lane) {
  // Opposite to the rounding of single precision: the wedge between is narrower than what walls are loosened
  // by.
  constexpr double kOpposite = 2e-7;
  const Vec3 a = normal_of(block.wall[0], lane), b = normal_of(block.wall[1], lane);
  return a == Vec3{} || b == Vec3{} || norm(a + b) > kOpposite;
}

bool has_interior(const VertexBlock&, int) {
  return true;
}

SiteRegion region_of(const Sites::Impl& sites, const FaceBlock& block, int lane) {
  SiteRegion region;
  region.type = SiteType::face;
  region.face = block.face[lane];
  region.axis = normal_of(block.plane, lane);
  const Triangle& t = sites.mesh.triangles[region.face];
  for (const std::uint32_t vertex : t)
    region.corners[region.corner_count++] = sites.frame.to_unit(sites.mesh.positions[vertex]);
  region.anchor = region.corners[0];
  for (const auto& wall : block.wall) add_wall(region, normal_of(wall, lane), wall[3][lane]);
  add_end_planes(region);
  region.strict_walls = region.wall_count;
  return region;
}

SiteRegion region_of(const Sites::Impl&, const EdgeBlock& block, int lane) {
  SiteRegion region;
  region.type = SiteType::edge;
  region.face = block.face[lane];
  region.anchor = get3(block.start, lane);
  region.axis = get3(block.direction, lane);
  region.corners = {region.anchor, region.anchor + double{block.length[lane]} * region.axis};
  region.corner_count = 2;
  add_wall(region, region.axis, dot(region.axis, region.corners[0]));
  add_wall(region, -region.axis, -dot(region.axis, region.corners[1]));
  region.strict_walls = 2;
  Vec3 former{};
  for (const auto& wall : block.wall) {
    const Vec3 inward = normal_of(wall, lane);
    if (inward == Vec3{} || inward == former) continue;
    add_wall(region, -inward, -wall[3][lane]);
    former = inward;
  }
  return region;
}

SiteRegion region_of(const Sites::Impl& sites, const VertexBlock& block, int lane) {
  SiteRegion region;
  region.type = SiteType::vertex;
  region.face = block.face[lane];
  const auto position = [&](std::uint32_t vertex) {
    return sites.frame.to_unit(sites.mesh.positions[vertex]);
  };
  region.anchor = position(block.vertex[lane]);
  region.corners = {region.anchor};
  region.corner_count = 1;
  for (int k = 0; k < VertexBlock::kRays; ++k) {
    const std::uint32_t neighbour = block.neighbour[k][lane];
    bool repeated = false;
    for (int j = 0; j < k; ++j) repeated |= block.neighbour[j][lane] == neighbour;
    const Vec3 ray = normalized(position(neighbour) - region.anchor);
    if (!repeated && ray != Vec3{}) add_wall(region, -ray, -dot(ray, region.anchor));
  }
  return region;
}

}  // namespace sdm::gl
