#include "atlas/charts/shape.h"

#include <algorithm>

#include "atlas/charts/tangent_frame.h"
#include "core/parallel.h"

namespace sdm::atlas {
namespace {

// The largest number of edges of a hull that are tried.
constexpr std::size_t kDirections = 256;

// The direction of a side of the smallest bounding rectangle: it lies along an edge of the hull (Freeman &
// Shapira 1975).
Vec2 least_rectangle(std::vector<Vec2> points) {
  const auto hull = convex_hull(std::move(points), [](const Vec2& p) -> const Vec2& { return p; });
  Vec2 best = {1, 0};
  double least = kInfinity;
  const std::size_t stride = hull.size() / kDirections + 1;
  for (std::size_t i = 0; i < hull.size(); i += stride) {
    const Vec2 edge = hull[(i + 1) % hull.size()] - hull[i];
    const double length = std::hypot(edge[0], edge[1]);
    if (!(length > 0)) continue;
    const Vec2 along = (1 / length) * edge;
    double lower = 0, upper = 0, height = 0;  // relative to the edge's start, all of the hull on its left
    for (const Vec2& p : hull) {
      lower = std::min(lower, dot(along, p - hull[i]));
      upper = std::max(upper, dot(along, p - hull[i]));
      height = std::max(height, cross(along, p - hull[i]));
    }
    if ((upper - lower) * height < least) {
      least = (upper - lower) * height;
      best = along;
    }
  }
  return best;
}

// The face's corners in shape coordinates.
std::array<Vec2, 3> project_face(const Mesh& mesh, const ShapeFrame& frame, std::uint32_t face) {
  const auto [i, j, k] = mesh.triangles[face];
  return {frame.project(mesh.positions[i]), frame.project(mesh.positions[j]),
          frame.project(mesh.positions[k])};
}

// A side of a face across which the neighbour is not in the chart; the face's position in the chart.
struct OuterSide {
  std::uint32_t face;
  int corner;
};

// `charts`: that of each face.
std::vector<OuterSide> outer_sides(const FaceGeometry& faces, const Chart& chart,
                                   std::span<const std::uint32_t> charts) {
  std::vector<OuterSide> sides;
  for (std::uint32_t i = 0; i < chart.faces.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t next = faces.neighbours[chart.faces[i]][k];
      if (next == kNone || charts[next] != charts[chart.faces[i]]) sides.push_back({i, k});
    }
  return sides;
}

// A frame in the plane of a face that agrees with `frame` of another face on their common edge.
ShapeFrame unfolded_frame(const Mesh& mesh, const FaceGeometry& faces, const Chart& chart,
                          const ShapeFrame& frame) {
  const auto [first, second] = std::pair(chart.faces[0], chart.faces[1]);
  const auto k = std::ranges::find(faces.neighbours[first], second) - faces.neighbours[first].begin();
  const Triangle& t = mesh.triangles[first];
  const Vec3& start = mesh.positions[t[k]];
  const Vec3 edge = normalized(mesh.positions[t[(k + 1) % 3]] - start);
  // Turns the direction normal to the edge in the plane of the first face into that of the second.
  const Vec3 from = cross(faces.normal[first], edge), to = cross(faces.normal[second], edge);
  const auto unfold = [&](const Vec3& v) { return dot(v, edge) * edge + dot(v, from) * to; };
  return {start, unfold(frame.right), unfold(frame.down), -1.0 * frame.project(start)};
}

// The corners of a chart's faces in shape coordinates. A common corner of unfolded faces has the same ones.
void project_faces(const Mesh& mesh, const Chart& chart, Shape& shape) {
  shape.triangles.clear();
  for (const std::uint32_t f : chart.faces)
    shape.triangles.push_back(
        project_face(mesh, chart.unfolded && f == chart.faces[1] ? shape.unfolded : shape.frame, f));
  if (!chart.unfolded) return;
  const Triangle &first = mesh.triangles[chart.faces[0]], &second = mesh.triangles[chart.faces[1]];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (first[i] == second[j]) shape.triangles[1][j] = shape.triangles[0][i];
}

// Turns a frame by the angle of the unit vector `side`, whose lower corner is then `lo`.
ShapeFrame turned(const ShapeFrame& frame, const Vec2& side, const Vec2& lo) {
  return {frame.origin, side[0] * frame.right + side[1] * frame.down,
          side[0] * frame.down - side[1] * frame.right,
          Vec2{dot(side, frame.corner), cross(side, frame.corner)} + lo};
}

// Turns the shape so that its smallest bounding rectangle is axis-aligned, with its lower corner at (0, 0).
void turn_upright(const Mesh& mesh, const Chart& chart, std::span<const OuterSide> sides, Shape& shape) {
  std::vector<Vec2> points;
  points.reserve(sides.size());
  for (const auto& [face, corner] : sides) points.push_back(shape.triangles[face][corner]);
  const Vec2 side = least_rectangle(points);
  Vec2 lo = {dot(side, points[0]), cross(side, points[0])};
  for (const Vec2& p : points) {
    lo[0] = std::min(lo[0], dot(side, p));
    lo[1] = std::min(lo[1], cross(side, p));
  }
  shape.frame = turned(shape.frame, side, lo);
  if (chart.unfolded) shape.unfolded = turned(shape.unfolded, side, lo);
  project_faces(mesh, chart, shape);
}

Shape chart_shape(const Mesh& mesh, const FaceGeometry& faces, const Chart& chart,
                  std::span<const std::uint32_t> charts) {
  Shape shape;
  const std::vector<OuterSide> sides = outer_sides(faces, chart, charts);
  const auto [right, up] = tangent_frame(chart.axis);
  shape.frame = {mesh.positions[mesh.triangles[chart.faces[0]][0]], right, -up, {}};
  if (chart.unfolded) shape.unfolded = unfolded_frame(mesh, faces, chart, shape.frame);
  shape.triangles.reserve(chart.faces.size());
  project_faces(mesh, chart, shape);
  turn_upright(mesh, chart, sides, shape);
  double largest_area = -1;
  for (std::uint32_t i = 0; i < shape.triangles.size(); ++i) {
    const auto& t = shape.triangles[i];
    const double area = 0.5 * std::abs(cross(t[1] - t[0], t[2] - t[0]));
    shape.area += area;
    if (area > largest_area) {
      largest_area = area;
      shape.largest = i;
    }
  }
  for (const auto& [face, k] : sides) {
    const Vec2 &from = shape.triangles[face][k], &to = shape.triangles[face][(k + 1) % 3];
    shape.outline.push_back({from, to});
    shape.perimeter += std::hypot(to[0] - from[0], to[1] - from[1]);
    for (int i = 0; i < 2; ++i) shape.size[i] = std::max(shape.size[i], from[i]);
  }
  return shape;
}

}  // namespace

Vec2 ShapeFrame::project(const Vec3& p) const {
  const Vec3 d = p - origin;
  return Vec2{dot(right, d), dot(down, d)} - corner;
}

std::vector<Shape> chart_shapes(const Mesh& mesh, const FaceGeometry& faces, std::span<const Chart> charts) {
  std::vector<Shape> shapes(charts.size());
  std::vector<std::uint32_t> chart_of(mesh.triangles.size(), kNone);
  for (std::uint32_t c = 0; c < charts.size(); ++c)
    for (const std::uint32_t f : charts[c].faces) chart_of[f] = c;
  parallel_for(charts.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) shapes[c] = chart_shape(mesh, faces, charts[c], chart_of);
  });
  return shapes;
}

}  // namespace sdm::atlas
