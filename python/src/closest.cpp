#include "closest.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sdm::python {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// The areas of the triangles opposite to the corners, relative to that of the face, which has one.
Vec3 weights_in_face(const std::array<Vec3, 3>& corners, const Vec3& p) {
  const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  Vec3 weights;
  for (int k = 0; k < 3; ++k) {
    const Vec3 area = cross(corners[(k + 1) % 3] - p, corners[(k + 2) % 3] - p);
    weights[k] = std::max(0.0, dot(normal, area));
  }
  const double sum = weights[0] + weights[1] + weights[2];
  return sum > 0 ? Vec3{weights[0] / sum, weights[1] / sum, weights[2] / sum} : Vec3{1, 0, 0};
}

}  // namespace

void PyClosestPoints::set_gradients(std::span<const Vec3> points) {
  has_gradients_ = true;
  gradients.assign(found.size(), Vec3{});
  for_parts(found.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double distance = distance_of(i);
      if (found[i].type == SiteType::none || distance == 0) continue;
      const Vec3 to_point = points[i] - found[i].point;
      for (int k = 0; k < 3; ++k) gradients[i][k] = to_point[k] / distance;
    }
  });
}

Vec3 PyClosestPoints::barycentric_of(const ClosestPoint& closest) const {
  if (closest.type == SiteType::none) return {kNan, kNan, kNan};
  const Sites& mesh = version->get();
  const Triangle& triangle = mesh.mesh().triangles[closest.face];
  Vec3 weights{};
  if (closest.type == SiteType::face) {
    const std::vector<Vec3>& at = *positions;
    return weights_in_face({at[triangle[0]], at[triangle[1]], at[triangle[2]]}, closest.point);
  }
  const auto corner = [&](std::uint32_t vertex) {
    return std::ranges::find(triangle, vertex) - triangle.begin();
  };
  if (closest.type == SiteType::vertex) {
    weights[corner(closest.site)] = 1;
    return weights;
  }
  const auto [from, to] = mesh.edges()[closest.site];
  const Vec3 along = (*positions)[to] - (*positions)[from];
  const double t = dot(closest.point - (*positions)[from], along) / dot(along, along);
  weights[corner(to)] = t >= 0 ? std::min(t, 1.0) : 0;  // 0 also for an edge without length
  weights[corner(from)] = 1 - weights[corner(to)];
  return weights;
}

void PyClosestPoints::require_gradients() const {
  if (!has_gradients_)
    throw Error("the derivatives are not there; call closest_points() with gradients=True");
}

nb::object PyClosestPoints::distance() {
  return distance_.get([&] {
    return column(found, [this](const ClosestPoint& c) { return distance_of(&c - found.data()); });
  });
}

nb::object PyClosestPoints::point() {
  return point_.get([&] {
    return column(found, [](const ClosestPoint& c) {
      return c.type == SiteType::none ? Vec3{kNan, kNan, kNan} : c.point;
    });
  });
}

nb::object PyClosestPoints::face() {
  return face_.get([&] { return column(found, [](const ClosestPoint& c) { return c.face; }); });
}

nb::object PyClosestPoints::barycentric() {
  const auto lock = sites->access.use();
  return barycentric_.get(
      [&] { return column(found, [this](const ClosestPoint& c) { return barycentric_of(c); }); });
}

nb::object PyClosestPoints::site() {
  return site_.get([&] { return column(found, [](const ClosestPoint& c) { return c.site; }); });
}

nb::object PyClosestPoints::site_type() {
  return site_type_.get(
      [&] { return column(found, [](const ClosestPoint& c) { return static_cast<std::uint8_t>(c.type); }); });
}

nb::object PyClosestPoints::gradient() {
  if (!has_gradients_) return nb::none();
  return gradient_.get([&] { return column(gradients, [](const Vec3& g) { return g; }); });
}

nb::object PyClosestPoints::vertex_gradients() const {
  require_gradients();
  const auto lock = sites->access.use();
  const auto& triangles = version->get().mesh().triangles;
  std::vector<Triangle> vertices(found.size());
  std::vector<std::array<Vec3, 3>> derivatives(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].type == SiteType::none) continue;
    vertices[i] = triangles[found[i].face];
    // The closest point moves with its face; the motion within the face does not change the distance.
    const Vec3 weights = barycentric_of(found[i]);
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) derivatives[i][k][axis] = -weights[k] * gradients[i][axis];
  }
  return nb::make_tuple(array_of<std::uint32_t>(std::move(vertices), {found.size(), 3}),
                        array_of<double>(std::move(derivatives), {found.size(), 3, 3}));
}

}  // namespace sdm::python
