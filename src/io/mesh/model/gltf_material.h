// Materials of glTF.
#pragma once

#include <sdm/mesh_attributes.h>
#include <tiny_gltf.h>

#include <span>

#include "io/mesh/model/glb_model.h"

namespace sdm::io {

/// The factors of a material, with what its alpha means. Faces have two sides, so that open meshes have a
/// back.
[[nodiscard]] tinygltf::Material factors_of(const Material& material);

/// Adds materials with the pictures that they refer to, as they are.
void add_materials(GlbModel& glb, std::span<const Material> materials, std::span<const TextureFile> textures);

}  // namespace sdm::io
