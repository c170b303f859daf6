#include "bodies/motion/parts.h"

#include <algorithm>
#include <cmath>

#include "geometry/vec.h"
#include "registration/eigen.h"
#include "tree/fold.h"

namespace sdm::motion {
namespace {

// Larger nodes keep the box of the tree: fitting them would take as long as a search.
constexpr std::size_t kMostFaces = 1024;

double area(const Vec3& half) {
  return half[0] * half[1] + half[1] * half[2] + half[2] * half[0];
}

}  // namespace

Parts::Parts(const MovingSurface& surface)
    : sites_(surface.sites),
      motion_(surface.motion),
      unit_(1 / sites_.frame.scale),
      origin_(sites_.frame.origin - motion_.middle()) {}

double Parts::size(const Place& place) const {
  if (place.face) return 0;
  const auto& [lo, hi] = sites_.tree.box(place.source);
  return motion_.scale() * unit_ * (double{hi[0] - lo[0]} + double{hi[1] - lo[1]} + double{hi[2] - lo[2]});
}

// The part is valid until the next call for a face of this surface.
const Part& Parts::at(const Place& place) {
  if (place.face) return face_ = face(place.child);
  const auto [known, added] = boxes_.try_emplace(place.source);
  if (added) {
    known->second = box_of_tree(place.source);
    if (const std::span faces = items_below(sites_.tree, place.source); faces.size() <= kMostFaces)
      known->second = fitted(faces, known->second);
  }
  return known->second;
}

double Parts::from_axis(const Vec3& p) const {
  return motion_.scale() * norm(cross(p, motion_.mesh_axis()));
}

Part Parts::face(std::uint32_t index) const {
  Part part{.points = 3};
  for (int i = 0; i < 3; ++i) {
    part.point[i] = corner(index, i);
    part.radius[i] = from_axis(part.point[i]);
    part.from_middle = std::max(part.from_middle, motion_.scale() * norm(part.point[i]));
  }
  part.axis[0] = normalized(cross(part.point[1] - part.point[0], part.point[2] - part.point[0]));
  return part;
}

Part Parts::box_of_tree(std::uint32_t node) const {
  const tree::FloatBox& box = sites_.tree.box(node);
  Part part;
  for (int k = 0; k < 3; ++k) {
    part.point[0][k] = origin_[k] + unit_ * (0.5 * (double{box.lower[k]} + box.upper[k]));
    part.half[k] = unit_ * (0.5 * (double{box.upper[k]} - box.lower[k]));
    part.axis[k][k] = 1;
  }
  part.radius[0] = from_axis(part.point[0]) + motion_.scale() * norm(part.half);
  part.from_middle = motion_.scale() * (norm(part.point[0]) + norm(part.half));
  return part;
}

// Around a flat or thin patch in any direction, a box along the principal axes of its corners is as thin as
// the patch. Some of the corners will do for the axes.
Part Parts::fitted(std::span<const std::uint32_t> faces, const Part& box) const {
  constexpr std::size_t kSamples = 64;
  const std::size_t every = 1 + faces.size() / kSamples;
  const Vec3& from = box.point[0];
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  double count = 0;
  for (std::size_t f = 0; f < faces.size(); f += every)
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d r = registration::vector(corner(faces[f], i) - from);
      sum += r;
      squares += r * r.transpose();
      ++count;
    }
  const Eigen::Matrix3d moments = squares - sum * sum.transpose() / count;
  const auto principal = registration::spectrum(moments);
  Part part;
  // Perpendicular to each other to the last digit, as the box requires.
  part.axis[0] = normalized(registration::vec3(principal.vectors.col(0)));
  part.axis[2] = normalized(cross(part.axis[0], registration::vec3(principal.vectors.col(1))));
  part.axis[1] = cross(part.axis[2], part.axis[0]);
  Box extent;
  double radius = 0, from_middle = 0;  // squared
  for (const std::uint32_t face : faces)
    for (int i = 0; i < 3; ++i) {
      const Vec3 p = corner(face, i), r = p - from;
      extend(extent, Vec3{dot(r, part.axis[0]), dot(r, part.axis[1]), dot(r, part.axis[2])});
      radius = std::max(radius, squared_norm(cross(p, motion_.mesh_axis())));
      from_middle = std::max(from_middle, squared_norm(p));
    }
  part.half = 0.5 * (extent.upper - extent.lower);
  if (principal.found && area(part.half) < area(box.half)) {
    part.point[0] = from;
    for (int k = 0; k < 3; ++k) part.point[0] += (0.5 * (extent.lower[k] + extent.upper[k])) * part.axis[k];
  } else {
    part = box;
  }
  part.radius[0] = motion_.scale() * std::sqrt(radius);
  part.from_middle = motion_.scale() * std::sqrt(from_middle);
  return part;
}

}  // namespace sdm::motion
