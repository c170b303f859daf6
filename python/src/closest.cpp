#include "closest.h"

#include <sdm/closest_points.h>
#include <sdm/error.h>
#include <sdm/sites.h>

#include <algorithm>

#include "arrays.h"

namespace sdm::python {
namespace {

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

Vec3 Found::gradient_of(std::size_t i, const Vec3& point) const {
  const double distance = distance_of(i);
  if (closest[i].type == SiteType::none || distance == 0) return {};
  const Vec3 to_point = point - closest[i].point;
  return {to_point[0] / distance, to_point[1] / distance, to_point[2] / distance};
}

Found search(const Sites& sites, std::span<const Vec3> points, const MapOptions& options) {
  Found found{
      closest_points(
          sites, points,
          {.engine = options.engine, .max_distance = options.max_distance, .progress = options.progress}),
      {}};
  if (options.sign != SignMethod::none) {
    const SignMethod sign = choose_sign(sites, options.sign).method;
    if (sign != SignMethod::none) found.inside = inside_flags(sites, points, found.closest, sign);
  }
  return found;
}

Vec3 weights_of(const Sites& sites, std::span<const Vec3> positions, const ClosestPoint& closest) {
  if (closest.type == SiteType::none) return kNoPoint;
  const Triangle& triangle = sites.mesh().triangles[closest.face];
  Vec3 weights{};
  if (closest.type == SiteType::face)
    return weights_in_face({positions[triangle[0]], positions[triangle[1]], positions[triangle[2]]},
                           closest.point);
  const auto corner = [&](std::uint32_t vertex) {
    return std::ranges::find(triangle, vertex) - triangle.begin();
  };
  if (closest.type == SiteType::vertex) {
    weights[corner(closest.site)] = 1;
    return weights;
  }
  const auto [from, to] = sites.edges()[closest.site];
  const Vec3 along = positions[to] - positions[from];
  const double t = dot(closest.point - positions[from], along) / dot(along, along);
  weights[corner(to)] = t >= 0 ? std::min(t, 1.0) : 0;  // 0 also for an edge without length
  weights[corner(from)] = 1 - weights[corner(to)];
  return weights;
}

PyClosestPoints::PyClosestPoints(Found stored, bool has_gradients, std::vector<Vec3> of_points,
                                 StoredFaces faces)
    : found(std::move(stored)),
      gradients(std::move(of_points)),
      has_gradients_(has_gradients),
      stored_(std::move(faces)) {}

Use PyClosestPoints::use() const {
  return sites ? sites->access.use() : Use();
}

Vec3 PyClosestPoints::barycentric_of(std::size_t i) const {
  return stored_ ? stored_->weights[i] : weights_of(version->get(), *positions, found.closest[i]);
}

Triangle PyClosestPoints::corners_of(std::size_t i) const {
  if (stored_) return stored_->corners[i];
  const ClosestPoint& closest = found.closest[i];
  return closest.type == SiteType::none ? Triangle{} : version->get().mesh().triangles[closest.face];
}

StoredFaces PyClosestPoints::stored_faces() const {
  const auto lock = use();
  StoredFaces result{std::vector<Triangle>(size()), std::vector<Vec3>(size())};
  for (std::size_t i = 0; i < size(); ++i) {
    result.corners[i] = corners_of(i);
    result.weights[i] = barycentric_of(i);
  }
  return result;
}

void PyClosestPoints::set_gradients(std::span<const Vec3> points) {
  has_gradients_ = true;
  gradients.resize(size());
  for_parts(size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) gradients[i] = found.gradient_of(i, points[i]);
  });
}

void PyClosestPoints::require_gradients() const {
  if (!has_gradients_)
    throw Error("the derivatives are not there; call closest_points() with gradients=True");
}

nb::object PyClosestPoints::distance() {
  return distance_.get([&] {
    return column(found.closest,
                  [this](const ClosestPoint& c) { return found.distance_of(&c - found.closest.data()); });
  });
}

nb::object PyClosestPoints::point() {
  return point_.get([&] {
    return column(found.closest,
                  [](const ClosestPoint& c) { return c.type == SiteType::none ? kNoPoint : c.point; });
  });
}

nb::object PyClosestPoints::face() {
  return face_.get([&] { return column(found.closest, [](const ClosestPoint& c) { return c.face; }); });
}

nb::object PyClosestPoints::barycentric() {
  const auto lock = use();
  return barycentric_.get([&] {
    return column(found.closest, [this](const ClosestPoint& c) {
      return barycentric_of(static_cast<std::size_t>(&c - found.closest.data()));
    });
  });
}

nb::object PyClosestPoints::site() {
  return site_.get([&] { return column(found.closest, [](const ClosestPoint& c) { return c.site; }); });
}

nb::object PyClosestPoints::site_type() {
  return site_type_.get([&] {
    return column(found.closest, [](const ClosestPoint& c) { return static_cast<std::uint8_t>(c.type); });
  });
}

nb::object PyClosestPoints::gradient() {
  if (!has_gradients_) return nb::none();
  return gradient_.get([&] { return column(gradients, [](const Vec3& g) { return g; }); });
}

nb::object PyClosestPoints::vertex_gradients() const {
  require_gradients();
  const auto lock = use();
  std::vector<Triangle> vertices(size());
  std::vector<std::array<Vec3, 3>> derivatives(size());
  for (std::size_t i = 0; i < size(); ++i) {
    if (found.closest[i].type == SiteType::none) continue;
    vertices[i] = corners_of(i);
    // The closest point moves with its face; the motion within the face does not change the distance.
    const Vec3 weights = barycentric_of(i);
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) derivatives[i][k][axis] = -weights[k] * gradients[i][axis];
  }
  return nb::make_tuple(array_of<std::uint32_t>(std::move(vertices), {size(), 3}),
                        array_of<double>(std::move(derivatives), {size(), 3, 3}));
}

nb::object PyClosestPoints::pull_back(nb::handle upstream, std::size_t count) const {
  require_gradients();
  const Lengths by_distance(upstream, "upstream", size());
  const auto lock = use();
  std::vector<Vec3> of_points(size()), of_vertices(count);
  for (std::size_t i = 0; i < size(); ++i) {
    if (found.closest[i].type == SiteType::none) continue;
    of_points[i] = by_distance.get()[i] * gradients[i];
    const Triangle corners = corners_of(i);
    const Vec3 weights = barycentric_of(i);
    for (int k = 0; k < 3; ++k)
      if (weights[k] != 0 && corners[k] < count)
        of_vertices[corners[k]] = of_vertices[corners[k]] - weights[k] * of_points[i];
  }
  return nb::make_tuple(array_of<double>(std::move(of_points), {size(), 3}),
                        array_of<double>(std::move(of_vertices), {count, 3}));
}

}  // namespace sdm::python
