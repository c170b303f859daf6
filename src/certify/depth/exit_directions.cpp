#include "certify/depth/exit_directions.h"

#include <algorithm>
#include <limits>

#include "bodies/shape/extreme_vertex.h"

namespace sdm::depth {

void ExitDirections::start(const sites::SitesData& body, const sites::SitesData& solid,
                           const mesh::Similarity& to_solid) {
  body_ = &body;
  solid_ = &solid;
  to_solid_ = to_solid;
  size_ = 0;
}

void ExitDirections::add(const Vec3& u, const std::optional<Vec3>& far) {
  if (size_ == kMost) return;
  Direction& direction = directions_[size_++];
  direction.u = u;
  direction.most = far ? shape::extreme_vertex(*solid_, u, {dot(u, *far), *far}).along
                       : shape::extreme_vertex(*solid_, u).along;
  // u·(A x + a) = (Aᵀu)·x + u·a, and x = o + y / s for y in the unit frame.
  const Vec3 along = in_body(u);
  for (int k = 0; k < 3; ++k) direction.in_unit[k] = static_cast<float>(along[k] / body_->frame.scale);
  direction.most_in_unit =
      static_cast<float>(direction.most - dot(u, to_solid_.map.offset) - dot(along, body_->frame.origin));
}

Vec3 ExitDirections::in_body(const Vec3& u) const {
  const Affine& map = to_solid_.map;
  return u[0] * map.rows[0] + u[1] * map.rows[1] + u[2] * map.rows[2];
}

double ExitDirections::bound(const Corners& triangle) const {
  double least = kInfinity;
  for (std::size_t i = 0; i < size_; ++i) {
    const Direction& d = directions_[i];
    least = std::min(
        least, d.most - std::min({dot(d.u, triangle[0]), dot(d.u, triangle[1]), dot(d.u, triangle[2])}));
  }
  return least;
}

void ExitDirections::values(const Corners& triangle, std::vector<CornerValues>& values) const {
  for (std::size_t i = 0; i < size_; ++i) {
    const Direction& d = directions_[i];
    values.push_back(
        {d.most - dot(d.u, triangle[0]), d.most - dot(d.u, triangle[1]), d.most - dot(d.u, triangle[2])});
  }
}

double ExitDirections::bound(const shape::Ball& ball, std::size_t first) const {
  double least = kInfinity;
  for (std::size_t i = first; i < size_; ++i)
    least = std::min(least, directions_[i].most - dot(directions_[i].u, ball.centre) + ball.radius);
  return least;
}

ExitDirections::OfChildren ExitDirections::bound_children(const tree::WideTree::Node& node) const {
  constexpr float kExitRounding =
      8e-6F;  // in the unit frame, in which the boxes are at most 1 from the origin
  OfChildren least;
  least.fill(std::numeric_limits<float>::infinity());
  for (std::size_t n = 0; n < size_; ++n) {
    const Direction& d = directions_[n];
    OfChildren most;
    float size = std::abs(d.most_in_unit);
    for (const float x : d.in_unit) size += std::abs(x);
    most.fill(d.most_in_unit + kExitRounding * size);
    for (int k = 0; k < 3; ++k) {
      const float* near = d.in_unit[k] > 0 ? node.lower[k] : node.upper[k];
      for (std::size_t i = 0; i < most.size(); ++i) most[i] -= d.in_unit[k] * near[i];
    }
    for (std::size_t i = 0; i < most.size(); ++i) least[i] = std::min(least[i], most[i]);
  }
  return least;
}

Vec3 ExitDirections::farthest_from_exit() const {
  const Vec3 u = normalized(-in_body(directions_[size_ - 1].u));
  return to_solid_.map(shape::extreme_vertex(*body_, u).point);
}

}  // namespace sdm::depth
