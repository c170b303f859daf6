// The trees of nodes of a glTF file.
#pragma once

#include <sdm/types.h>

#include <array>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "io/mesh/gltf/document/gltf_document.h"

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

/// Returns the root nodes of the default scene; without one, of the first scene; without any scene, all nodes
/// without a parent.
[[nodiscard]] std::vector<std::size_t> gltf_scene_roots(const GltfDocument& document);
/// Returns all nodes without a parent.
[[nodiscard]] std::vector<std::size_t> gltf_roots(const GltfDocument& document);

/// Visits the nodes below and including `roots`, depth first, with their transforms to the scene. Throws
/// sdm::Error for a node with two parents, which could form a cycle or a tree of exponential size; glTF
/// forbids it.
void visit_gltf_nodes(const GltfDocument& document, const std::vector<std::size_t>& roots,
                      const std::function<void(std::size_t node, const GltfTransform& to_scene)>& visit);

}  // namespace sdm::io
