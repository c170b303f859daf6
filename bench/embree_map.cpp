#include "embree_map.h"

#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace sdm::bench {
namespace {

Vec3f single(const Vec3& a) {
  return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}

/// The closest point of a triangle to the origin, by the signs of the barycentric coordinates of its
/// projection.
Vec3f closest_to_origin(const std::array<Vec3f, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const Vec3f ab = b - a, ac = c - a, bc = c - b;
  const float a_ab = -dot(a, ab), a_ac = -dot(a, ac);
  if (a_ab <= 0 && a_ac <= 0) return a;
  const float b_ab = -dot(b, ab), b_ac = -dot(b, ac);
  if (b_ab >= 0 && b_ac <= b_ab) return b;
  const float c_ab = -dot(c, ab), c_ac = -dot(c, ac);
  if (c_ac >= 0 && c_ab <= c_ac) return c;
  const float weight_c = a_ab * b_ac - b_ab * a_ac;
  if (weight_c <= 0 && a_ab >= 0 && b_ab <= 0) return a + (a_ab / (a_ab - b_ab)) * ab;
  const float weight_b = c_ab * a_ac - a_ab * c_ac;
  if (weight_b <= 0 && a_ac >= 0 && c_ac <= 0) return a + (a_ac / (a_ac - c_ac)) * ac;
  const float weight_a = b_ab * c_ac - c_ab * b_ac;
  const float towards_c = b_ac - b_ab, towards_b = c_ab - c_ac;
  if (weight_a <= 0 && towards_c >= 0 && towards_b >= 0)
    return b + (towards_c / (towards_c + towards_b)) * bc;
  const float scale = 1 / (weight_a + weight_b + weight_c);
  return a + (weight_b * scale) * ab + (weight_c * scale) * ac;
}

struct ProximityQuery {
  const std::vector<std::array<Vec3f, 3>>* triangles;
  EmbreeTexel* texel;
};

bool visit(RTCPointQueryFunctionArguments* arguments) {
  const auto& query = *static_cast<const ProximityQuery*>(arguments->userPtr);
  EmbreeTexel& texel = *query.texel;
  const auto& [a, b, c] = (*query.triangles)[arguments->primID];
  const Vec3f vector = closest_to_origin({a - texel.point, b - texel.point, c - texel.point});
  const float distance = std::sqrt(dot(vector, vector));
  if (distance >= arguments->query->radius) return false;
  texel.vector = vector;
  texel.distance = distance;
  texel.face = arguments->primID;
  arguments->query->radius = distance;
  return true;  // the search radius has changed
}

}  // namespace

EmbreeScene::EmbreeScene(const Mesh& mesh)
    : device_(rtcNewDevice(nullptr)), scene_(build_scene(device_.get(), mesh, RTC_BUILD_QUALITY_HIGH)) {
  for (const auto& [a, b, c] : mesh.triangles)
    triangles_.push_back({single(mesh.positions[a]), single(mesh.positions[b]), single(mesh.positions[c])});
}

void EmbreeScene::closest(std::span<EmbreeTexel> texels) const {
  parallel_for(texels.size(), 1024, [&](std::size_t begin, std::size_t end) {
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f& p = texels[i].point;
      RTCPointQuery query{p[0], p[1], p[2], 0, std::numeric_limits<float>::infinity()};
      ProximityQuery user{&triangles_, &texels[i]};
      rtcPointQuery(scene_.get(), &query, &context, visit, &user);
    }
  });
}

}  // namespace sdm::bench
