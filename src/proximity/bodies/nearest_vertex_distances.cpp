#include <sdm/multi_body_query.h>
#include <sdm/vertex_distances.h>

#include <cmath>
#include <limits>

namespace sdm {

std::vector<float> nearest_distances_at_vertices(const MultiBodyQuery& bodies, std::size_t body,
                                                 double max_distance) {
  const Mesh& mesh = bodies.surface(body).mesh();
  std::vector<float> nearest(mesh.positions.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t other = 0; other < bodies.size(); ++other) {
    if (other == body) continue;
    const std::vector<float> distances =
        distances_at_vertices(mesh, bodies.sites(other), {.max_distance = max_distance});
    for (std::size_t v = 0; v < nearest.size(); ++v)
      if (std::isnan(nearest[v]) || std::abs(distances[v]) < std::abs(nearest[v])) nearest[v] = distances[v];
  }
  return nearest;
}

}  // namespace sdm
