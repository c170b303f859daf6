// The triangles in the scene of a glTF file.
#pragma once

#include <set>
#include <vector>

#include "io/mesh/gltf/document/gltf_document.h"
#include "io/mesh/gltf/gltf_instances.h"
#include "io/mesh/gltf/gltf_pose.h"
#include "io/mesh/polygons/polygon_mesh.h"

namespace sdm::io {

/// Returns whether a primitive consists of triangles, not points or lines. Throws sdm::Error if it does but
/// its data are compressed.
[[nodiscard]] bool has_triangles(const GltfDocument& document, const nlohmann::json& primitive);

/// Returns all triangles of the instances, which are all those of the document's scene. The vertices of their
/// primitives are concatenated. Morph targets and skins are applied as they are in the file, but no morph
/// targets to the nodes of `unmorphed`. `attributes`: also those of vertices, see GltfAttributes. `pose`: of
/// the joints of skins; null: that of the file.
[[nodiscard]] PolygonMesh read_gltf_scene(const GltfDocument& document,
                                          const std::vector<GltfInstance>& instances,
                                          const std::set<std::size_t>& unmorphed = {},
                                          bool attributes = false, const GltfPose* pose = nullptr);

}  // namespace sdm::io
