// A body: a shape in a pose.
#pragma once

#include <sdm/shape.h>

#include <algorithm>
#include <span>
#include <utility>

#include "bodies/shape/body.h"
#include "geometry/rounding.h"
#include "mesh/similarity.h"

namespace sdm::shape {

/// Throws sdm::Error unless a body with that box has, in that pose, coordinates that meshes can have:
/// distances are then finite. Returns a box that contains the posed body.
Box check_posed(const mesh::Similarity& pose, const Box& box);
/// check_posed() of the box of a body; that of a half-space is the box of all coordinates.
Box check_posed(const mesh::Similarity& pose, const Body& body);

class PosedBody {
 public:
  /// A pose, and a box that contains the body in it.
  struct Placed {
    mesh::Similarity pose;
    Box box{};
  };

  explicit PosedBody(Shape shape) : shape_(std::move(shape)) { follow(); }

  /// Throws sdm::Error unless the pose is a Similarity that keeps the body where it can be computed with.
  /// Cost: constant.
  void set_pose(const Transform& pose) {
    const Placed placed = checked_pose(pose);
    pose_ = placed.pose;
    follow(placed.box);
  }
  /// Returns the members that set_pose() would set. Throws as it does.
  [[nodiscard]] Placed checked_pose(const Transform& pose) const;
  /// Throws sdm::Error if another Shape shares the mesh.
  void require_own_shape() const;
  /// Throws sdm::Error for positions that are not valid for the mesh, and if another Shape shares it.
  void check_refit(std::span<const Vec3> positions) const;
  /// Moves the vertices to positions that were checked; they are in the frame of the mesh.
  void refit(std::span<const Vec3> positions) {
    internals(shape_)->refit(positions);
    follow();
  }

  /// Requires a shape of its own. Throws as Body::edit does, and for vertices that the pose moves too far.
  void edit(const MeshEdit& edit) {
    check_edit(edit);
    internals(shape_)->edit(edit);
    follow();
  }
  /// Throws sdm::Error, and changes nothing, if the pose moves the shape too far.
  void replace(Shape shape) {
    check_posed(pose_, *internals(shape));
    shape_ = std::move(shape);
    follow();
  }

  [[nodiscard]] const Body& body() const { return *internals(shape_); }
  [[nodiscard]] const mesh::Similarity& pose() const { return pose_; }
  /// A box that contains the posed body.
  [[nodiscard]] const Box& box() const { return box_; }
  /// A ball that contains it.
  [[nodiscard]] const Ball& ball() const { return ball_; }
  /// The intersection of the box with that of the ball, which is smaller for bodies that are round and
  /// turned.
  [[nodiscard]] Box tight_box() const {
    const Vec3 reach{ball_.radius, ball_.radius, ball_.radius};
    Box box{ball_.centre - reach, ball_.centre + reach};
    for (int k = 0; k < 3; ++k) {
      box.lower[k] = std::max(box.lower[k], box_.lower[k]);
      box.upper[k] = std::min(box.upper[k], box_.upper[k]);
    }
    return box;
  }

 private:
  void check_edit(const MeshEdit& edit) const;
  void follow() { follow(body().half_space() ? body().box() : image(pose_.map, body().box())); }
  void follow(const Box& box) {
    box_ = box;
    const auto& [centre, radius] = body().ball();
    if (body().half_space()) {
      ball_ = body().ball();
      return;
    }
    ball_ = {pose_.map(centre), pose_.scale * radius};
    ball_.radius += kFewRoundings * (norm(pose_.map.offset) + pose_.scale * (norm(centre) + radius));
  }

  Shape shape_;
  mesh::Similarity pose_;
  Box box_;
  Ball ball_;
};

}  // namespace sdm::shape

namespace sdm {

/// The data of Shape. Found by argument-dependent lookup.
[[nodiscard]] const std::shared_ptr<shape::Body>& internals(const Shape& shape);

}  // namespace sdm
