#include "research/figures/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"

namespace sdm::figures {
namespace {

constexpr std::uint32_t kAtlas = 32;

}  // namespace

double measured_gap(const Surface& surface, int divisions) {
  const std::vector<Vec3> samples = surface.sample_points();
  const Mesh& mesh = surface.mesh();
  std::vector<double> gaps(mesh.triangles.size());
  parallel_for(gaps.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      for (int i = 0; i <= divisions; ++i)
        for (int j = 0; i + j <= divisions; ++j) {
          const double u = static_cast<double>(i) / divisions, v = static_cast<double>(j) / divisions;
          const auto& [a, b, c] = mesh.triangles[f];
          const Vec3 p = (1 - u - v) * mesh.positions[a] + u * mesh.positions[b] + v * mesh.positions[c];
          double nearest = std::numeric_limits<double>::infinity();
          for (const Vec3& s : samples) nearest = std::min(nearest, squared_norm(s - p));
          gaps[f] = std::max(gaps[f], nearest);
        }
  });
  return std::sqrt(*std::ranges::max_element(gaps));
}

double lattice_radius(const Surface& surface, std::uint32_t face) {
  auto [a, b] = surface.texel_edges(face);
  // Lagrange's reduction: the shorter vector is taken off the longer one until that no longer helps.
  while (true) {
    if (squared_norm(b) < squared_norm(a)) std::swap(a, b);
    const double steps = std::round(dot(a, b) / squared_norm(a));
    if (steps == 0) break;
    b = b - steps * a;
  }
  if (dot(a, b) < 0) b = -b;  // the triangle of a, b and a − b is acute
  return norm(a) * norm(b) * norm(a - b) / (2 * norm(cross(a, b)));
}

double adjacent_distance(const Surface& surface, std::uint32_t face) {
  const auto [a, b] = surface.texel_edges(face);
  return std::max(norm(a + b), norm(a - b));
}

double paper_bound(double spacing, double width, double scale, double shear) {
  const double more = std::max(shear - (width / (scale * spacing) + 1), 0.0);
  return spacing * std::hypot(scale + more, scale);
}

Mesh rectangle(int columns, int rows, double spacing) {
  const double b = columns * spacing, h = rows * spacing;
  // Texture coordinates have v up, from the lower left corner of the image.
  const double u = static_cast<double>(columns) / kAtlas, v = static_cast<double>(rows) / kAtlas;
  return {{{0, 0, 0}, {b, 0, 0}, {b, h, 0}, {0, h, 0}},
          {{0, 1, 2}, {0, 2, 3}},
          {{Vec2{0, 0}, {u, 0}, {u, v}}, {Vec2{0, 0}, {u, v}, {0, v}}}};
}

Surface rectangle_surface(int columns, int rows, double spacing) {
  return Surface(rectangle(columns, rows, spacing), {.kind = AtlasKind::uv, .resolution = kAtlas});
}

}  // namespace sdm::figures
