// The box around a column, compared with eight boxes or faces at once.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "geometry/rounding.h"
#include "geometry/unit_frame.h"
#include "sites/regions.h"
#include "tree/wide_tree.h"

namespace sdm::shape {

/// A box along three axes, in the unit frame of a solid, in single precision. Excludes only what is farther
/// away from it than rounding.
class ColumnBox {
 public:
  /// The box from `lo` to `hi` along unit vectors, from an origin; in the frame of the solid.
  ColumnBox(const UnitFrame& frame, const Vec3& origin, const std::array<Vec3, 3>& axes, const Vec3& lo,
            const Vec3& hi) {
    const Vec3 from = frame.to_unit(origin);
    const double most = 4 * (1 + norm(from));  // farther than anything in the unit frame
    for (int a = 0; a < 3; ++a) {
      const double least = std::max(frame.scale * lo[a], -most), end = std::min(frame.scale * hi[a], most);
      middle_[a] = static_cast<float>(0.5 * (least + end) + dot(axes[a], from));
      half_[a] = static_cast<float>(0.5 * (end - least) + 4 * kSingleRounding * most);
      for (int k = 0; k < 3; ++k) axes_[a][k] = static_cast<float>(axes[a][k]);
    }
  }

  /// A bit for each child of a node whose box may meet this one.
  [[nodiscard]] std::uint32_t meets(const tree::WideTree::Node& node) const {
    float beyond[kWidth];
    std::ranges::fill(beyond, -std::numeric_limits<float>::infinity());
    for (int a = 0; a < 3; ++a) {
      const auto& [x, y, z] = axes_[a];
      const float ax = std::abs(x), ay = std::abs(y), az = std::abs(z), c = 2 * middle_[a], h = 2 * half_[a];
      for (int i = 0; i < kWidth; ++i) {
        const float at = x * (node.lower[0][i] + node.upper[0][i]) +
                         y * (node.lower[1][i] + node.upper[1][i]) +
                         z * (node.lower[2][i] + node.upper[2][i]);
        const float reach = ax * (node.upper[0][i] - node.lower[0][i]) +
                            ay * (node.upper[1][i] - node.lower[1][i]) +
                            az * (node.upper[2][i] - node.lower[2][i]);
        beyond[i] = std::max(beyond[i], std::abs(at - c) - reach - h);
      }
    }
    return not_beyond(beyond) & ((1u << node.count) - 1);
  }

  /// A bit for each lane of a leaf, used or not, whose face may meet this box.
  [[nodiscard]] std::uint32_t meets(const sites::FaceBounds& faces) const {
    float beyond[kWidth];
    std::ranges::fill(beyond, -std::numeric_limits<float>::infinity());
    for (int a = 0; a < 3; ++a) {
      const auto& [x, y, z] = axes_[a];
      for (int i = 0; i < kWidth; ++i) {
        const float at = x * faces.centre[0][i] + y * faces.centre[1][i] + z * faces.centre[2][i];
        beyond[i] = std::max(beyond[i], std::abs(at - middle_[a]) - faces.radius[i] - half_[a]);
      }
    }
    return not_beyond(beyond);
  }

 private:
  static constexpr int kWidth = tree::WideTree::kWidth;

  static std::uint32_t not_beyond(const float (&beyond)[kWidth]) {
    std::uint32_t bits = 0;
    for (int i = kWidth; i-- > 0;) bits = bits << 1 | std::uint32_t{!(beyond[i] > 0)};
    return bits;
  }

  std::array<std::array<float, 3>, 3> axes_;
  std::array<float, 3> middle_, half_;
};

}  // namespace sdm::shape
