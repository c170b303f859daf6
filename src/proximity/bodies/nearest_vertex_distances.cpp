#include <sdm/multi_body_query.h>
#include <sdm/vertex_distances.h>

#include <cmath>
#include <limits>
#include <new>

#include "core/memory.h"
#include "mesh/similarity.h"

namespace sdm {

std::vector<float> nearest_distances_at_vertices(const MultiBodyQuery& bodies, std::size_t body,
                                                 double max_distance) try {
  using mesh::Similarity;
  const Mesh& mesh = bodies.sites(body).mesh();
  const Similarity pose = Similarity::of(bodies.pose(body));
  Mesh in_frame = mesh;  // of the other body
  std::vector<float> nearest(mesh.positions.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t other = 0; other < bodies.size(); ++other) {
    if (other == body) continue;
    const Similarity other_pose = Similarity::of(bodies.pose(other));
    const Affine to_frame = inverse(other_pose.map) * pose.map;
    for (std::size_t v = 0; v < nearest.size(); ++v) in_frame.positions[v] = to_frame(mesh.positions[v]);
    const std::vector<float> distances = distances_at_vertices(
        in_frame, bodies.sites(other), {.max_distance = max_distance / other_pose.scale});
    for (std::size_t v = 0; v < nearest.size(); ++v) {
      const auto distance = static_cast<float>(other_pose.scale * distances[v]);
      if (std::isnan(nearest[v]) || std::abs(distance) < std::abs(nearest[v])) nearest[v] = distance;
    }
  }
  return nearest;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the distances of vertices");
}

}  // namespace sdm
