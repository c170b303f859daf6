// Transforms of glTF nodes.
#pragma once

#include <sdm/types.h>

#include <array>
#include <nlohmann/json_fwd.hpp>

#include "geometry/vec.h"

namespace sdm::io {

/// x ↦ linear · x + offset. `linear` holds columns.
struct GltfTransform {
  std::array<Vec3, 3> linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 offset{};

  [[nodiscard]] Vec3 turn(const Vec3& x) const {
    return x[0] * linear[0] + x[1] * linear[1] + x[2] * linear[2];
  }
  [[nodiscard]] Vec3 operator()(const Vec3& x) const { return turn(x) + offset; }
  [[nodiscard]] GltfTransform operator*(const GltfTransform& inner) const {
    return {{turn(inner.linear[0]), turn(inner.linear[1]), turn(inner.linear[2])}, (*this)(inner.offset)};
  }
  [[nodiscard]] double determinant() const { return dot(cross(linear[0], linear[1]), linear[2]); }
};

/// Scales, rotates by a quaternion (x, y, z, w) of any length, then translates. Throws sdm::Error if the
/// quaternion is zero.
[[nodiscard]] GltfTransform gltf_transform(const Vec3& translation, const std::array<double, 4>& rotation,
                                           const Vec3& scale);
/// A matrix in column-major order. Throws sdm::Error unless it is affine.
[[nodiscard]] GltfTransform gltf_matrix_transform(const std::array<double, 16>& matrix);
/// The local transform of a node.
[[nodiscard]] GltfTransform gltf_node_transform(const nlohmann::json& node);

}  // namespace sdm::io
