// The meshes in the scene of a glTF file.
#pragma once

#include <sdm/types.h>

#include <vector>

#include "core/geometry/vec.h"
#include "io/read/gltf/gltf_document.h"
#include "io/read/polygons/polygon_mesh.h"

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
  [[nodiscard]] bool mirrors() const { return dot(cross(linear[0], linear[1]), linear[2]) < 0; }
};

/// The mesh of a node, and its transform.
struct GltfInstance {
  std::size_t node, mesh;
  GltfTransform to_scene;
};

/// Returns all meshes of the default scene, in depth-first order of the nodes.
[[nodiscard]] std::vector<GltfInstance> gltf_instances(const GltfDocument& document);

/// Returns whether a primitive consists of triangles, not points or lines.
[[nodiscard]] bool has_triangles(const nlohmann::json& primitive);

enum GltfMode : std::size_t { kTriangles = 4, kStrip = 5, kFan = 6 };
[[nodiscard]] std::size_t gltf_mode(const nlohmann::json& primitive);

/// Returns all triangles of the scene. The vertices of the primitives are concatenated in the order of
/// gltf_instances.
[[nodiscard]] PolygonMesh read_gltf_scene(const GltfDocument& document);

}  // namespace sdm::io
