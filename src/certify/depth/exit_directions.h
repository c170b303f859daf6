// Bounds on a depth by the support function of the solid, in directions in which points leave it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "bodies/shape/node_ball.h"
#include "certify/depth/boundary.h"
#include "mesh/similarity.h"
#include "sites/sites_data.h"

namespace sdm::depth {

/// A point p inside a solid S leaves it in the direction u, |u| = 1, no later than at the supporting plane of
/// S there, so its distance to the boundary is
///   b(p) ≤ h(u) − u·p,  with the support function h(u) = max over x in S of u·x.
/// With the direction from the deepest point of another body to the boundary, this excludes all but a few of
/// its faces, without a search for any of them. Points and lengths are in the frame of the solid; only the
/// boxes of the body's tree are where the tree has them.
class ExitDirections {
 public:
  static constexpr std::size_t kMost = 8;

  /// Forgets all directions. `to_solid`: from the frame of the body to that of the solid.
  void start(const sites::SitesData& body, const sites::SitesData& solid, const mesh::Similarity& to_solid);
  /// Adds a direction of length 1, and if known a point of the solid that is far
  /// in it; ignored if there are kMost already. Cost: logarithmic, as of extreme_vertex().
  void add(const Vec3& u, const std::optional<Vec3>& far = {});
  [[nodiscard]] std::size_t size() const { return size_; }

  /// The bound on b of a triangle.
  [[nodiscard]] double bound(const Corners& triangle) const;
  /// The bound on b of a ball, by the directions from `first` on.
  [[nodiscard]] double bound(const shape::Ball& ball, std::size_t first) const;
  /// Appends the bounds at the corners of a triangle, one entry for each direction: they are linear.
  void values(const Corners& triangle, std::vector<CornerValues>& values) const;
  /// Bounds for the boxes of a node's children, in the unit frame of the body.
  using OfChildren = std::array<float, tree::WideTree::kWidth>;
  [[nodiscard]] OfChildren bound_children(const tree::WideTree::Node& node) const;

  /// The point of the body for which the last direction gives the largest bound.
  [[nodiscard]] Vec3 farthest_from_exit() const;

 private:
  /// b(p) ≤ most − u·p; the same in the unit frame of the body.
  struct Direction {
    Vec3 u;
    double most;
    float in_unit[3], most_in_unit;
  };
  [[nodiscard]] Vec3 in_body(const Vec3& u) const;

  const sites::SitesData *body_ = nullptr, *solid_ = nullptr;
  mesh::Similarity to_solid_;
  std::array<Direction, kMost> directions_{};
  std::size_t size_ = 0;
};

}  // namespace sdm::depth
