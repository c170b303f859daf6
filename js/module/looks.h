// How a mesh file looks.
#pragma once

#include <sdm/bake.h>

#include <vector>

namespace sdm::js {

/// Materials, textures, colours and normals of the faces of a file. JavaScript decodes the pictures.
struct Look {
  std::vector<Material> materials;
  std::vector<std::uint32_t> face_materials;
  std::vector<Image> pictures;  ///< empty until they are set
  std::vector<TextureFile> textures;
  std::vector<MeshAttribute> attributes;  ///< texture coordinates, as `uv0`, too

  [[nodiscard]] MeshLook view() const { return {materials, face_materials, pictures, attributes}; }
  /// The normals of the file; null: it has none.
  [[nodiscard]] const MeshAttribute* normals() const;
};

}  // namespace sdm::js
