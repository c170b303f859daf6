// A surface with textures, as glTF.
#pragma once

#include <sdm/map_files.h>
#include <tiny_gltf.h>

#include <span>

#include "io/mesh/model/glb_model.h"
#include "io/mesh/model/model_vertices.h"
#include "io/mesh/model/shading_normals.h"

namespace sdm::io {

/// What the primitives of a surface have in common.
struct DrawnSurface {
  const Mesh& mesh;
  const ShadingNormals& normals;
  Placement place;
  Vec2 extent;                              ///< the width and height of its textures, in texels of the atlas
  const MeshAttribute* tangents = nullptr;  ///< or null
};

/// Adds the accessors of a primitive with POSITION, NORMAL, TEXCOORD_0 and, if there are tangents, TANGENT,
/// of the first material, and returns it: more attributes may follow. There is at least one triangle.
[[nodiscard]] tinygltf::Primitive primitive_of(GlbModel& glb, const DrawnSurface& drawn,
                                               const ModelVertices& vertices);

/// The bytes that they take in the buffer, but for alignment.
[[nodiscard]] std::size_t bytes_of(const ModelVertices& vertices);

/// Adds a picture in a texture that does not repeat, with a filter for where it is made smaller. Returns the
/// number of the texture.
int add_png(GlbModel& glb, std::span<const char> png, int smaller);

/// The node of the only mesh of a model of O1.
[[nodiscard]] tinygltf::Node drawn_node(const Placement& place, UpAxis up);

}  // namespace sdm::io
