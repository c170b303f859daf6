#include "fcl_pair.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <limits>

namespace sdm::bench {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

std::unique_ptr<Model> model(const Mesh& mesh) {
  std::vector<fcl::Vector3d> vertices;
  for (const Vec3& p : mesh.positions) vertices.emplace_back(p[0], p[1], p[2]);
  std::vector<fcl::Triangle> triangles;
  for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
  auto result = std::make_unique<Model>();
  result->beginModel();
  result->addSubModel(vertices, triangles);
  result->endModel();
  return result;
}

fcl::Transform3d transform_of(const Affine& pose) {
  fcl::Transform3d result = fcl::Transform3d::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.linear()(i, j) = pose.rows[i][j];
    result.translation()(i) = pose.offset[i];
  }
  return result;
}

}  // namespace

struct FclPair::Impl {
  std::unique_ptr<Model> o1, o2;
  fcl::Transform3d in_place = fcl::Transform3d::Identity();
};

FclPair::FclPair(const Mesh& o1, const Mesh& o2) : impl_(new Impl{model(o1), model(o2)}) {}
FclPair::~FclPair() = default;

double FclPair::distance(const Affine& pose) const {
  const fcl::DistanceRequestd request(true);
  fcl::DistanceResultd result;
  fcl::distance(impl_->o1.get(), impl_->in_place, impl_->o2.get(), transform_of(pose), request, result);
  return result.min_distance;
}

bool FclPair::collide(const Affine& pose) const {
  const fcl::CollisionRequestd request(1, false);
  fcl::CollisionResultd result;
  fcl::collide(impl_->o1.get(), impl_->in_place, impl_->o2.get(), transform_of(pose), request, result);
  return result.isCollision();
}

FclPair::Contacts FclPair::contacts(const Affine& pose) const {
  const fcl::CollisionRequestd request(std::numeric_limits<std::size_t>::max(), true);
  fcl::CollisionResultd result;
  fcl::collide(impl_->o1.get(), impl_->in_place, impl_->o2.get(), transform_of(pose), request, result);
  Contacts contacts{.count = result.numContacts()};
  for (std::size_t i = 0; i < contacts.count; ++i)
    if (const fcl::Contactd& contact = result.getContact(i);
        i == 0 || contact.penetration_depth > contacts.deepest) {
      contacts.deepest = contact.penetration_depth;
      for (int k = 0; k < 3; ++k) contacts.deepest_normal[k] = contact.normal(k);
    }
  return contacts;
}

}  // namespace sdm::bench
