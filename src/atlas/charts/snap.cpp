#include "atlas/charts/snap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "atlas/charts/tangent_frame.h"
#include "geometry/vec.h"

namespace sdm::atlas {

std::vector<GridTriangle> snap(const Mesh& mesh, const Chart& chart) {
  const auto [right, up] = tangent_frame(chart.axis);
  const Vec3& origin = mesh.positions[mesh.triangles[chart.faces[0]][0]];
  std::vector<std::array<Vec2, 3>> projected;
  projected.reserve(chart.faces.size());
  Vec2 lo = {0, 0}, hi = {0, 0};
  for (const std::uint32_t f : chart.faces) {
    std::array<Vec2, 3>& corners = projected.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = mesh.positions[mesh.triangles[f][k]] - origin;
      corners[k] = {dot(p, right), dot(p, up)};
      for (int i = 0; i < 2; ++i) {
        lo[i] = std::min(lo[i], corners[k][i]);
        hi[i] = std::max(hi[i], corners[k][i]);
      }
    }
  }
  const double extent = std::max({hi[0] - lo[0], hi[1] - lo[1], std::numeric_limits<double>::min()});
  const auto step = [&](double x) { return static_cast<std::int32_t>(std::lround(x / extent * kGridSteps)); };
  std::vector<GridTriangle> snapped(projected.size());
  for (std::size_t i = 0; i < projected.size(); ++i)
    for (int k = 0; k < 3; ++k)
      snapped[i][k] = {step(projected[i][k][0] - lo[0]), step(projected[i][k][1] - lo[1])};
  return snapped;
}

}  // namespace sdm::atlas
