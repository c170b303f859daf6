#include <sdm/map.h>
#include <sdm/multi_body_query.h>

#include <cmath>
#include <limits>
#include <new>
#include <span>
#include <vector>

#include "core/memory.h"
#include "mesh/similarity.h"

namespace sdm {

namespace {

using mesh::Similarity;

// Lowers the distances of the vertices of a mesh in this pose to those to the parts of another body.
void keep_nearer(const MultiBodyQuery& bodies, std::size_t other, const Mesh& mesh, const Similarity& pose,
                 double max_distance, std::span<float> nearest) {
  Mesh in_frame = mesh;  // of a part of the other body
  for (std::size_t part = 0; part < bodies.part_count(other); ++part) {
    const Similarity other_pose = Similarity::of(bodies.part_pose(other, part));
    const Affine to_frame = inverse(other_pose.map) * pose.map;
    for (std::size_t v = 0; v < nearest.size(); ++v) in_frame.positions[v] = to_frame(mesh.positions[v]);
    const std::vector<float> distances = distances_at_vertices(
        in_frame, bodies.sites(other, part), {.max_distance = max_distance / other_pose.scale});
    for (std::size_t v = 0; v < nearest.size(); ++v) {
      const auto distance = static_cast<float>(other_pose.scale * distances[v]);
      if (std::isnan(nearest[v]) || std::abs(distance) < std::abs(nearest[v])) nearest[v] = distance;
    }
  }
}

}  // namespace

std::vector<float> nearest_distances_at_vertices(const MultiBodyQuery& bodies, std::size_t body,
                                                 double max_distance) try {
  std::vector<float> nearest;
  for (std::size_t part = 0; part < bodies.part_count(body); ++part) {
    const Mesh& mesh = bodies.sites(body, part).mesh();
    const Similarity pose = Similarity::of(bodies.part_pose(body, part));
    const std::size_t first = nearest.size();
    nearest.resize(first + mesh.positions.size(), std::numeric_limits<float>::quiet_NaN());
    for (std::size_t other = 0; other < bodies.size(); ++other)
      if (other != body)
        keep_nearer(bodies, other, mesh, pose, max_distance, std::span(nearest).subspan(first));
  }
  return nearest;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the distances of vertices");
}

}  // namespace sdm
