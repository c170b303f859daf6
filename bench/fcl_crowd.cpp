#include "fcl_crowd.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>

namespace sdm::bench {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;
using Object = fcl::CollisionObjectd;

void set_vertices(std::vector<fcl::Vector3d>& vertices, std::span<const Vec3> positions) {
  vertices.clear();
  for (const Vec3& p : positions) vertices.emplace_back(p[0], p[1], p[2]);
}

struct Body {
  std::shared_ptr<Model> model = std::make_shared<Model>();
  std::unique_ptr<Object> object;
};

struct PairQuery {
  double max_distance;
  std::vector<FclCrowd::Pair>& pairs;
};

// Called for pairs of boxes nearer than `reach`; a search for the nearest pair would reduce it.
bool measure(Object* a, Object* b, void* data, double& reach) {
  auto& query = *static_cast<PairQuery*>(data);
  reach = query.max_distance;
  if (a->getAABB().distance(b->getAABB()) > reach) return false;
  fcl::DistanceResultd result;
  fcl::distance(a, b, fcl::DistanceRequestd(true), result);
  const auto number = [](const Object* object) {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(object->getUserData()));
  };
  const std::uint32_t i = number(a), j = number(b);
  query.pairs.push_back({std::min(i, j), std::max(i, j), result.min_distance});
  return false;
}

}  // namespace

struct FclCrowd::Impl {
  std::vector<Body> bodies;
  fcl::DynamicAABBTreeCollisionManagerd manager;
  std::vector<fcl::Vector3d> vertices;
  std::vector<Pair> pairs;
};

FclCrowd::FclCrowd(std::span<const Mesh> meshes) : impl_(new Impl) {
  for (const Mesh& mesh : meshes) {
    Body& body = impl_->bodies.emplace_back();
    set_vertices(impl_->vertices, mesh.positions);
    std::vector<fcl::Triangle> triangles;
    for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
    body.model->beginModel();
    body.model->addSubModel(impl_->vertices, triangles);
    body.model->endModel();
    body.object = std::make_unique<Object>(body.model);
    // NOLINTNEXTLINE(performance-no-int-to-ptr): a number as user data; nothing dereferences it
    body.object->setUserData(reinterpret_cast<void*>(impl_->bodies.size() - 1));
    impl_->manager.registerObject(body.object.get());
  }
  impl_->manager.setup();
}
FclCrowd::~FclCrowd() = default;

void FclCrowd::move(std::span<const Transform> poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    fcl::Transform3d pose = fcl::Transform3d::Identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) pose.linear()(row, column) = poses[i].rows[row][column];
      pose.translation()(row) = poses[i].rows[row][3];
    }
    Object& object = *impl_->bodies[i].object;
    object.setTransform(pose);
    object.computeAABB();
  }
  impl_->manager.update();
}

void FclCrowd::refit(std::span<const std::vector<Vec3>> positions) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    Body& body = impl_->bodies[i];
    set_vertices(impl_->vertices, positions[i]);
    body.model->beginReplaceModel();
    body.model->replaceSubModel(impl_->vertices);
    // Top down: bottom-up refits enlarge the boxes, which makes queries tens of times slower.
    constexpr bool kRefit = true, kBottomUp = false;
    body.model->endReplaceModel(kRefit, kBottomUp);
    body.model->computeLocalAABB();
    body.object->computeAABB();
  }
  impl_->manager.update();
}

std::span<const FclCrowd::Pair> FclCrowd::distances(double max_distance) {
  impl_->pairs.clear();
  PairQuery query{max_distance, impl_->pairs};
  impl_->manager.distance(&query, measure);
  std::ranges::sort(impl_->pairs, {}, [](const Pair& p) { return std::pair(p.first, p.second); });
  return impl_->pairs;
}

}  // namespace sdm::bench
