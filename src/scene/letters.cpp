#include "scene/letters.h"

#include <libqhull_r/qhull_ra.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "core/vec.h"
#include "scene/letter_outline.h"

namespace sdm {
namespace {

using Side = std::array<std::uint32_t, 2>;

/// A flat shape in triangles, counter-clockwise. Its border comes first among the points.
struct Shape {
  std::vector<Vec2> points;
  std::vector<Side> border;  ///< the shape on the left
  std::vector<Triangle> triangles;
};

/// By the crossings of a ray to the right.
bool is_inside(const Shape& shape, const Vec2& p) {
  bool inside = false;
  for (const auto& [i, j] : shape.border) {
    const Vec2 &a = shape.points[i], &b = shape.points[j];
    if ((a[1] > p[1]) != (b[1] > p[1]) && (cross(b - a, p - a) > 0) == (b[1] > a[1])) inside = !inside;
  }
  return inside;
}

double distance_to_border(const Shape& shape, const Vec2& p) {
  double squared = std::numeric_limits<double>::infinity();
  for (const auto& [i, j] : shape.border) {
    const Vec2 a = shape.points[i] - p, side = shape.points[j] - shape.points[i];
    const Vec2 nearest = a + std::clamp(-dot(a, side) / dot(side, side), 0.0, 1.0) * side;
    squared = std::min(squared, dot(nearest, nearest));
  }
  return std::sqrt(squared);
}

Shape outline(char character, double spacing) {
  Shape shape;
  for (const Contour& contour : letter_outline(character, spacing)) {
    const auto first = static_cast<std::uint32_t>(shape.points.size());
    const auto n = static_cast<std::uint32_t>(contour.size());
    for (std::uint32_t i = 0; i < n; ++i) shape.border.push_back({first + i, first + (i + 1) % n});
    shape.points.insert(shape.points.end(), contour.begin(), contour.end());
  }
  return shape;
}

/// Adds points of a hexagonal grid inside. They keep away from the border: the circles over its sides, half a
/// spacing in radius, stay empty, which makes Delaunay triangulations keep the sides.
void add_inner_points(Shape& shape, double spacing) {
  constexpr double kAway = 0.7;
  Vec2 lo = shape.points[0], hi = lo;
  for (const Vec2& p : shape.points)
    for (int k = 0; k < 2; ++k) lo[k] = std::min(lo[k], p[k]), hi[k] = std::max(hi[k], p[k]);
  std::vector<Vec2> inner;
  bool odd = false;
  for (double y = lo[1]; y < hi[1]; y += 0.5 * std::numbers::sqrt3 * spacing, odd = !odd)
    for (double x = lo[0] + (odd ? 0.5 * spacing : 0); x < hi[0]; x += spacing)
      if (is_inside(shape, {x, y}) && distance_to_border(shape, {x, y}) > kAway * spacing)
        inner.push_back({x, y});
  shape.points.insert(shape.points.end(), inner.begin(), inner.end());
}

/// Counter-clockwise.
std::vector<Triangle> delaunay(std::vector<Vec2> points) {
  qhT qhull;
  qh_zero(&qhull, stderr);
  char command[] = "qhull d Qt Qbb Qc";
  const int failed = qh_new_qhull(&qhull, 2, static_cast<int>(points.size()), points.data()->data(), False,
                                  command, nullptr, stderr);
  std::vector<Triangle> triangles;
  if (failed == 0)
    for (const facetT* facet = qhull.facet_list; facet->next != nullptr; facet = facet->next) {
      if (facet->upperdelaunay) continue;
      Triangle& t = triangles.emplace_back();
      for (int k = 0; k < 3; ++k)
        t[k] = static_cast<std::uint32_t>(qh_pointid(&qhull, SETelemt_(facet->vertices, k, vertexT)->point));
      if (cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]) < 0) std::swap(t[1], t[2]);
    }
  qh_freeqhull(&qhull, !qh_ALL);
  int left = 0, left_bytes = 0;
  qh_memfreeshort(&qhull, &left, &left_bytes);
  if (failed != 0) throw Error("Qhull failed to triangulate a letter");
  return triangles;
}

/// Triangulates the shape. Returns whether its border is that of the triangles.
bool fill(Shape& shape) {
  std::set<Side> sides;
  for (const Triangle& t : delaunay(shape.points)) {
    const Vec2 &a = shape.points[t[0]], &b = shape.points[t[1]], &c = shape.points[t[2]];
    if (!is_inside(shape, (1.0 / 3) * (a + b + c))) continue;
    shape.triangles.push_back(t);
    for (int k = 0; k < 3; ++k) sides.insert({t[k], t[(k + 1) % 3]});
  }
  const bool each_once = sides.size() == 3 * shape.triangles.size();
  std::erase_if(sides, [all = sides](const Side& side) { return all.contains({side[1], side[0]}); });
  return each_once && sides == std::set<Side>(shape.border.begin(), shape.border.end());
}

/// The solid between the shape at z = −depth/2 and at depth/2, with walls of `layers` rows of squares.
Mesh extrude(const Shape& shape, double depth, std::uint32_t layers) {
  const auto points = static_cast<std::uint32_t>(shape.points.size());
  const auto border = static_cast<std::uint32_t>(shape.border.size());
  Mesh mesh;
  const auto add = [&](const Vec2& p, double z) { mesh.positions.push_back({p[0], p[1], z}); };
  for (const Vec2& p : shape.points) add(p, -0.5 * depth);
  for (const Vec2& p : shape.points) add(p, 0.5 * depth);
  for (std::uint32_t layer = 1; layer < layers; ++layer)
    for (std::uint32_t i = 0; i < border; ++i)
      add(shape.points[i], depth * (static_cast<double>(layer) / layers - 0.5));
  const auto vertex = [&](std::uint32_t i, std::uint32_t layer) {
    if (layer == 0) return i;
    return layer == layers ? points + i : 2 * points + (layer - 1) * border + i;
  };

  for (const auto& [a, b, c] : shape.triangles) {
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({points + a, points + b, points + c});
  }
  for (const auto& [i, j] : shape.border)
    for (std::uint32_t layer = 0; layer < layers; ++layer) {
      mesh.triangles.push_back({vertex(i, layer), vertex(j, layer), vertex(j, layer + 1)});
      mesh.triangles.push_back({vertex(i, layer), vertex(j, layer + 1), vertex(i, layer + 1)});
    }
  return mesh;
}

}  // namespace

Mesh letter(char character, double spacing) {
  Shape shape = outline(character, spacing);
  add_inner_points(shape, spacing);
  if (!fill(shape))
    throw Error(std::string("the letter '") + character + "' has parts too thin for a spacing of " +
                std::to_string(spacing));
  const double layers = std::max(1.0, std::round(kLetterDepth / spacing));
  return extrude(shape, kLetterDepth, static_cast<std::uint32_t>(layers));
}

Mesh letter_of(char character, std::size_t triangles) {
  const auto miss = [triangles](const Mesh& mesh) {
    return std::abs(static_cast<double>(mesh.triangles.size()) - static_cast<double>(triangles));
  };
  // n even triangles of side s have an area of 0.43 n s², and letters one between 0.43 and 6.9. Their number
  // falls with s, but for rows of points that come and go.
  double fine = 1 / std::sqrt(static_cast<double>(triangles)), coarse = 4 * fine;
  Mesh best = letter(character, coarse);
  for (int i = 0; i < 16; ++i) {
    const double spacing = std::sqrt(fine * coarse);
    Mesh mesh = letter(character, spacing);
    (mesh.triangles.size() < triangles ? coarse : fine) = spacing;
    if (miss(mesh) < miss(best)) best = std::move(mesh);
  }
  return best;
}

}  // namespace sdm
