// Morph targets: position = rest + Σ weight · displacement.
#pragma once

#include <optional>
#include <vector>

#include "io/mesh/gltf/document/gltf_rows.h"
#include "io/mesh/gltf/gltf_instances.h"

namespace sdm::io {

/// Returns the number of morph targets of a mesh: the most that a primitive has. The last ones do not change
/// primitives that have fewer.
[[nodiscard]] std::size_t gltf_target_count(const GltfDocument& document, std::size_t mesh);

/// Returns the weights that the file gives the targets of a node's mesh: those of the node, otherwise those
/// of the mesh, otherwise zeros. Throws sdm::Error unless there is one for each target.
[[nodiscard]] std::vector<double> gltf_weights(const GltfDocument& document, const GltfInstance& instance);

/// Returns the displacements of each target of a primitive; none for a target without positions. Throws
/// sdm::Error if their number is not that of the vertices.
[[nodiscard]] std::vector<std::optional<GltfRows>> gltf_displacements(const GltfDocument& document,
                                                                      const nlohmann::json& primitive);

/// The vertices of a primitive, displaced by its morph targets, in the coordinates of the mesh. The document
/// must outlive the object.
class GltfPositions {
 public:
  /// Targets without a weight, beyond the last one, are left out. Throws sdm::Error for faults.
  GltfPositions(const GltfDocument& document, const nlohmann::json& primitive, std::vector<double> weights);

  [[nodiscard]] std::size_t size() const { return rest_.rows(); }
  [[nodiscard]] Vec3 operator[](std::size_t vertex) const;

 private:
  GltfRows rest_;
  std::vector<std::optional<GltfRows>> displacements_;
  std::vector<double> weights_;
};

}  // namespace sdm::io
