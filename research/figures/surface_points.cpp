#include "research/figures/surface_points.h"

#include <sdm/closest_points.h>

#include <algorithm>
#include <cmath>

#include "research/figures/random.h"

namespace sdm::figures {

SurfacePoints surface_points(const Mesh& mesh, const Sites& sites, std::size_t count) {
  std::vector<double> areas;  // up to and including each face
  double total = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    total += 0.5 * norm(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
    areas.push_back(total);
  }
  Random random(7);
  const auto unit = [&] { return random.unit(); };
  SurfacePoints result;
  for (std::size_t i = 0; i < count; ++i) {
    const double place = (static_cast<double>(i) + unit()) / static_cast<double>(count) * total;
    const auto face = static_cast<std::uint32_t>(
        std::min<std::size_t>(std::ranges::upper_bound(areas, place) - areas.begin(), areas.size() - 1));
    const double s = std::sqrt(unit()), t = unit();
    const auto& [a, b, c] = mesh.triangles[face];
    result.faces.push_back(face);
    result.points.push_back((1 - s) * mesh.positions[a] + s * (1 - t) * mesh.positions[b] +
                            s * t * mesh.positions[c]);
  }
  for (const ClosestPoint& c : closest_points(sites, result.points, {.engine = make_engine("reference")}))
    result.distances.push_back(c.distance);
  return result;
}

}  // namespace sdm::figures
