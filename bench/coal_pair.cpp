#include "coal_pair.h"

#include <coal/BVH/BVH_model.h>
#include <coal/collision.h>
#include <coal/distance.h>
#include <coal/shape/convex.h>
#include <coal/shape/geometric_shapes.h>

#include <utility>

namespace sdm::bench {
namespace {

coal::Vec3s vector_of(const Vec3& p) {
  return {p[0], p[1], p[2]};
}

std::pair<std::shared_ptr<std::vector<coal::Vec3s>>, std::shared_ptr<std::vector<coal::Triangle>>> arrays_of(
    const Mesh& mesh) {
  auto points = std::make_shared<std::vector<coal::Vec3s>>();
  auto triangles = std::make_shared<std::vector<coal::Triangle>>();
  for (const Vec3& p : mesh.positions) points->push_back(vector_of(p));
  for (const auto& [a, b, c] : mesh.triangles) triangles->emplace_back(a, b, c);
  return {points, triangles};
}

coal::Transform3s transform_of(const Transform& pose) {
  coal::Matrix3s rotation;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rotation(i, j) = pose.rows[i][j];
  return {rotation, vector_of({pose.rows[0][3], pose.rows[1][3], pose.rows[2][3]})};
}

}  // namespace

CoalShape coal_sphere(double radius) {
  return std::make_shared<coal::Sphere>(radius);
}
CoalShape coal_capsule(double radius, double length) {
  return std::make_shared<coal::Capsule>(radius, length);
}
CoalShape coal_cylinder(double radius, double length) {
  return std::make_shared<coal::Cylinder>(radius, length);
}
CoalShape coal_box(const Vec3& sides) {
  return std::make_shared<coal::Box>(vector_of(sides));
}
CoalShape coal_half_space(const Vec3& normal, double offset) {
  return std::make_shared<coal::Halfspace>(vector_of(normal), offset);
}
CoalShape coal_hull(const Mesh& mesh) {
  const auto [points, triangles] = arrays_of(mesh);
  return std::make_shared<coal::Convex<coal::Triangle>>(points, static_cast<unsigned>(points->size()),
                                                        triangles, static_cast<unsigned>(triangles->size()));
}
CoalShape coal_mesh(const Mesh& mesh) {
  const auto [points, triangles] = arrays_of(mesh);
  auto model = std::make_shared<coal::BVHModel<coal::OBBRSS>>();
  model->beginModel();
  model->addSubModel(*points, *triangles);
  model->endModel();
  return model;
}

struct CoalPair::Impl {
  CoalShape o1, o2;
  coal::ComputeDistance distance;
  coal::ComputeCollision collision;
  coal::Transform3s here{};
  std::vector<coal::Transform3s> poses{};
  coal::DistanceRequest unsigned_distance{true, false}, signed_distance{true, true};
  coal::CollisionRequest any{coal::NO_REQUEST, 1};

  Impl(const CoalShape& first, const CoalShape& second)
      : o1(first), o2(second), distance(o1.get(), o2.get()), collision(o1.get(), o2.get()) {}

  [[nodiscard]] double ask(std::size_t pose, const coal::DistanceRequest& request) const {
    coal::DistanceResult result;
    distance(here, poses[pose], request, result);
    request.updateGuess(result);
    return result.min_distance;
  }
};

CoalPair::CoalPair(CoalShape o1, CoalShape o2, const std::vector<Transform>& poses, bool warm)
    : impl_(std::make_unique<Impl>(o1, o2)) {
  for (const Transform& pose : poses) impl_->poses.push_back(transform_of(pose));
  if (!warm) return;
  for (coal::QueryRequest* request : std::initializer_list<coal::QueryRequest*>{
           &impl_->unsigned_distance, &impl_->signed_distance, &impl_->any})
    request->gjk_initial_guess = coal::GJKInitialGuess::CachedGuess;
}
CoalPair::~CoalPair() = default;

double CoalPair::distance(std::size_t pose) const {
  return impl_->ask(pose, impl_->unsigned_distance);
}
double CoalPair::signed_distance(std::size_t pose) const {
  return impl_->ask(pose, impl_->signed_distance);
}
bool CoalPair::collide(std::size_t pose) const {
  coal::CollisionResult result;
  impl_->collision(impl_->here, impl_->poses[pose], impl_->any, result);
  impl_->any.updateGuess(result);
  return result.isCollision();
}

}  // namespace sdm::bench
