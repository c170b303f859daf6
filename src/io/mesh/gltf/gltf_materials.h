// The materials of glTF.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/mesh/gltf/document/gltf_document.h"
#include "io/mesh/polygons/polygon_materials.h"

namespace sdm::io {

/// Reads all materials and the pictures of their textures, each once. Pictures in files are looked up in
/// `folder`. A texture that cannot be had is left out, with a note that names it: its factor remains.
void read_gltf_materials(const GltfDocument& document, const std::filesystem::path& folder,
                         PolygonMaterials& materials, std::vector<std::string>& notes);

}  // namespace sdm::io
