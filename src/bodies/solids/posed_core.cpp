#include "bodies/solids/posed_core.h"

#include "bodies/convex/support_search.h"
#include "bodies/shape/extreme_vertex.h"

namespace sdm::solids {
namespace {

// Two unit vectors whose sine is below this are parallel: the middle of a disc is then as far along the one
// as its rim, to rounding.
constexpr double kParallel = 1e-15;

}  // namespace

PosedCore::PosedCore(const shape::PosedBody& body) : body_(&body) {
  const Core& core = body.body().core();
  const Affine& pose = body.pose().map;
  const double scale = body.pose().scale;
  kind_ = core.kind;
  radius_ = scale * core.radius;
  switch (kind_) {
    case CoreKind::mesh:
      convex_ = body.body().convex_solid();
      centre_ = body.ball().centre;
      return;
    case CoreKind::axis:
      centre_ = pose.offset;
      axis_ = normalized(pose.linear({0, 0, 1}));
      half_ = scale * core.half_length * axis_;
      disc_ = scale * core.disc;
      return;
    case CoreKind::half_space:
      axis_ = normalized(pose.linear(core.normal));
      centre_ = pose(core.offset * core.normal);
      offset_ = dot(axis_, centre_);
      return;
  }
}

Vec3 PosedCore::support(const Vec3& u, std::uint32_t& near) const {
  if (triangle_) {
    const double a = dot(u, corners_[0]), b = dot(u, corners_[1]), c = dot(u, corners_[2]);
    return corners_[a >= b && a >= c ? 0 : b >= c ? 1 : 2];
  }
  if (kind_ == CoreKind::axis) {
    const double along = dot(u, axis_);
    Vec3 p = along < 0 ? centre_ - half_ : centre_ + half_;
    if (disc_ == 0) return p;
    const Vec3 across = u - along * axis_;
    if (!(norm(across) > kParallel)) return p;
    // Where u is nearly parallel to the axis, rounding leaves some of it.
    const Vec3 aside = normalized(across);
    return p + disc_ * normalized(aside - dot(aside, axis_) * axis_);
  }
  const Affine& pose = body_->pose().map;
  const auto& rows = pose.rows;
  const Vec3 local = u[0] * rows[0] + u[1] * rows[1] + u[2] * rows[2];
  if (convex_ == nullptr)
    return pose(shape::extreme_vertex(internals(body_->body().sites()), normalized(local)).point) + moved_;
  near = convex::farthest_vertex(*convex_, normalized(local), near);
  return pose(convex_->points[near]) + moved_;
}

PosedCore PosedCore::moved(const Vec3& by) const {
  PosedCore result = *this;
  result.centre_ += by;
  result.moved_ += by;
  for (Vec3& corner : result.corners_) corner += by;
  return result;
}

}  // namespace sdm::solids
