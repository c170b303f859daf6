#include "scenes/reduce_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <map>

namespace sdm::scenes {
namespace {

// Removes both of two faces that have the same three vertices: their neighbours then share the edges.
void remove_pairs(std::vector<Triangle>& triangles) {
  std::map<Triangle, std::size_t> counts;
  const auto sorted = [](Triangle t) {
    std::ranges::sort(t);
    return t;
  };
  for (const Triangle& t : triangles) ++counts[sorted(t)];
  std::erase_if(triangles, [&](const Triangle& t) { return counts[sorted(t)] == 2; });
}

}  // namespace

Mesh reduce_mesh(const Mesh& mesh, std::size_t triangles) {
  std::vector<Vec3f> points;
  points.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions)
    points.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});

  constexpr float kAnyError = 1;  // relative to the mesh's size: only the count limits the reduction
  std::vector<Triangle> kept(mesh.triangles.size());
  const std::size_t corners = meshopt_simplify(
      kept.data()->data(), mesh.triangles.data()->data(), 3 * mesh.triangles.size(), points.data()->data(),
      points.size(), sizeof(Vec3f), 3 * std::min(triangles, mesh.triangles.size()), kAnyError, 0, nullptr);
  kept.resize(corners / 3);
  remove_pairs(kept);

  Mesh result;
  result.positions.resize(mesh.positions.size());
  result.positions.resize(meshopt_optimizeVertexFetch(result.positions.data(), kept.data()->data(),
                                                      3 * kept.size(), mesh.positions.data(),
                                                      mesh.positions.size(), sizeof(Vec3)));
  result.triangles = std::move(kept);
  return result;
}

}  // namespace sdm::scenes
