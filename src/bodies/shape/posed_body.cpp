#include "bodies/shape/posed_body.h"

#include <sdm/error.h>

#include "geometry/vec.h"
#include "mesh/validate.h"

namespace sdm::shape {

Box check_posed(const mesh::Similarity& pose, const Box& box) {
  const Box posed = image(pose.map, box);
  for (int k = 0; k < 3; ++k)
    if (!(posed.lower[k] >= -mesh::kMaxCoordinate && posed.upper[k] <= mesh::kMaxCoordinate))
      throw Error("the pose moves it beyond 1e37, too far for the computation; use smaller values");
  return posed;
}

Box check_posed(const mesh::Similarity& pose, const Body& body) {
  if (!body.half_space()) return check_posed(pose, body.box());
  const solids::Core& core = body.core();
  check_posed(pose, Box{core.offset * core.normal, core.offset * core.normal});
  return body.box();
}

PosedBody::Placed PosedBody::checked_pose(const Transform& pose) const {
  const mesh::Similarity checked = mesh::Similarity::of(pose);
  const Placed result{.pose = checked, .box = check_posed(checked, body())};
  if (!(result.pose.scale * diagonal(body().box()) > mesh::kMinSize))
    throw Error("the pose makes it smaller than 1e-30, too small for the computation; scale it up");
  return result;
}

void PosedBody::require_own_shape() const {
  body().require_deformable();
  if (internals(shape_).use_count() > 1)
    throw Error(
        "its shape is shared and cannot be deformed; give a body that deforms a Shape of its own, and keep "
        "no copy");
}

void PosedBody::check_refit(std::span<const Vec3> positions) const {
  require_own_shape();
  mesh::validate_positions(positions, body().sites().mesh().positions.size());
  Box box;
  for (const Vec3& p : positions) extend(box, p);
  check_posed(pose_, box);
}

void PosedBody::check_edit(const MeshEdit& edit) const {
  if (edit.moved_vertices.empty() && edit.added_vertices.empty()) return;
  Box box = body().box();
  const auto add = [&](const Vec3& p) {
    if (finite(p)) extend(box, p);  // Body::edit refuses the others, and names them
  };
  for (const MeshEdit::MovedVertex& moved : edit.moved_vertices) add(moved.position);
  for (const Vec3& p : edit.added_vertices) add(p);
  check_posed(pose_, box);
}

}  // namespace sdm::shape
