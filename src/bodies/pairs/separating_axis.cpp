#include "bodies/pairs/separating_axis.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/rounding.h"

namespace sdm::pairs {
namespace {

// Tests for an axis that separates the surfaces, by the boxes around them: far cheaper than a search.
class SeparatingAxis {
 public:
  explicit SeparatingAxis(const MeshPair& pair) : pair_(pair) {
    const tree::FloatBox &box1 = pair.o1.tree.box(0), &box2 = pair.o2.tree.box(0);
    const UnitFrame &frame1 = pair.o1.frame, &frame2 = pair.o2.frame;
    const double unit1 = 1 / frame1.scale, unit2 = 1 / frame2.scale;
    const auto middle = [](const tree::FloatBox& box, int k) {
      return 0.5 * (double{box.lower[k]} + box.upper[k]);
    };
    const auto half = [](const tree::FloatBox& box, int k) {
      return 0.5 * (double{box.upper[k]} - box.lower[k]);
    };
    for (int k = 0; k < 3; ++k) {
      const Vec3& row = pair.pose.rows[k];
      double at = pair.pose.offset[k], size = std::abs(at) + std::abs(frame1.origin[k]) + unit1;
      half1_[k] = unit1 * half(box1, k);
      for (int j = 0; j < 3; ++j) {
        at += row[j] * (frame2.origin[j] + unit2 * middle(box2, j));
        size += std::abs(row[j]) * (std::abs(frame2.origin[j]) + unit2);
        edge_[j][k] = row[j] * unit2 * half(box2, j);
      }
      between_[k] = at - frame1.origin[k] - unit1 * middle(box1, k);
      rounding_[k] = kDoubleRounding * size;
    }
  }

  // Tries the axes of the separating axis theorem, the normals of faces and the products of two edges, of the
  // whole boxes. The one that overlaps least may separate those of the children.
  bool exists() {
    for (int k = 0; k < 3; ++k) {
      Vec3 axis{};
      axis[k] = 1;
      if (separates(axis)) return true;
    }
    for (int j = 0; j < 3; ++j)
      if (separates(cross(edge_[j], edge_[(j + 1) % 3]))) return true;
    if (separates_children(between_)) return true;
    for (const auto& [x, y, z] : edge_)
      if (separates({0, -z, y}) || separates({z, 0, -x}) || separates({-y, x, 0})) return true;
    return separates_children(best_);
  }

 private:
  // Whether this axis does, by the boxes around the surfaces.
  bool separates(const Vec3& axis) {
    double halves = 0;
    for (int k = 0; k < 3; ++k) halves += std::abs(axis[k]) * (half1_[k] + rounding_[k]);
    for (int j = 0; j < 3; ++j) halves += std::abs(dot(axis, edge_[j]));
    const double overlap = halves - std::abs(dot(axis, between_));
    if (overlap < 0) return true;
    // Compared without roots: overlap / |axis|.
    const double squared = overlap * overlap, size = squared_norm(axis);
    if (squared * least_size_ < least_ * size) {
      least_ = squared;
      least_size_ = size;
      best_ = axis;
    }
    return false;
  }

  // Whether an axis separates the boxes around the children of the roots.
  bool separates_children(const Vec3& axis) const {
    const Vec3 u = dot(axis, between_) < 0 ? -axis : axis;
    Vec3 u2;
    for (int j = 0; j < 3; ++j)
      u2[j] = -(pair_.pose.rows[0][j] * u[0] + pair_.pose.rows[1][j] * u[1] + pair_.pose.rows[2][j] * u[2]);
    double error = 0;
    for (int k = 0; k < 3; ++k) error += 2 * std::abs(u[k]) * rounding_[k];
    return extent(pair_.o1, u) + extent(pair_.o2, u2) < dot(u, pair_.pose.offset) - error;
  }
  // The largest x·u over the surface, at most.
  static double extent(const sites::SitesData& sites, const Vec3& u) {
    const tree::WideTree::Node& root = sites.wide.nodes[0];
    double most = -kInfinity;
    for (std::uint32_t i = 0; i < root.count; ++i) {
      double along = 0;
      for (int k = 0; k < 3; ++k) along += u[k] * double{(u[k] > 0 ? root.upper : root.lower)[k][i]};
      most = std::max(most, along);
    }
    return dot(u, sites.frame.origin) + most / sites.frame.scale;
  }

  const MeshPair& pair_;
  Vec3 between_{}, half1_{};    // from one middle to the other; of O1's box
  std::array<Vec3, 3> edge_{};  // of O2's box, half as long
  Vec3 rounding_{};             // bounds on the errors of coordinates
  Vec3 best_{};                 // the axis along which they overlap least
  double least_ = 1;            // the square of that overlap, times that of the axis' length
  double least_size_ = 0;       // the latter; at first, the overlap is infinite
};

}  // namespace

bool have_separating_axis(const MeshPair& pair) {
  return SeparatingAxis(pair).exists();
}

}  // namespace sdm::pairs
