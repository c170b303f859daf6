// A body: a shape in a pose.
#pragma once

#include <sdm/shape.h>

#include <span>
#include <utility>

#include "mesh/similarity.h"
#include "proximity/shape/body.h"

namespace sdm::shape {

class PosedBody {
 public:
  explicit PosedBody(Shape shape) : shape_(std::move(shape)) { follow(); }

  /// Throws sdm::Error unless the pose is a Similarity. Cost: constant.
  void set_pose(const Transform& pose) {
    pose_ = mesh::Similarity::of(pose);
    follow();
  }
  /// Throws sdm::Error if another Shape shares the mesh.
  void require_own_shape() const;
  /// Throws sdm::Error for positions that are not valid for the mesh, and if another Shape shares it.
  void check_refit(std::span<const Vec3> positions) const;
  /// Moves the vertices to positions that were checked; they are in the frame of the mesh.
  void refit(std::span<const Vec3> positions) {
    internals(shape_)->refit(positions);
    follow();
  }

  /// Requires a shape of its own. Throws as Body::edit does.
  void edit(const MeshEdit& edit) {
    internals(shape_)->edit(edit);
    follow();
  }
  void replace(Shape shape) {
    shape_ = std::move(shape);
    follow();
  }

  [[nodiscard]] const Body& body() const { return *internals(shape_); }
  [[nodiscard]] const mesh::Similarity& pose() const { return pose_; }
  /// A box that contains the posed body.
  [[nodiscard]] const Box& box() const { return box_; }

 private:
  void follow() { box_ = image(pose_.map, body().box()); }

  Shape shape_;
  mesh::Similarity pose_;
  Box box_;
};

}  // namespace sdm::shape

namespace sdm {

/// The data of Shape. Found by argument-dependent lookup.
[[nodiscard]] const std::shared_ptr<shape::Body>& internals(const Shape& shape);

}  // namespace sdm
