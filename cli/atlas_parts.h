// The meshes that atlases are made of: mostly the input; for textures that repeat its faces cut to one tile,
// and for UDIM textures a mesh for each tile.
#pragma once

#include <sdm/sdm.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

struct AtlasPart {
  std::optional<sdm::Mesh> mesh{};           ///< nothing: the input's
  std::vector<std::uint32_t> source_face{};  ///< of each face of `mesh`, that of the input
  std::optional<int> udim{};                 ///< the number of the tile
  std::size_t cut_faces = 0;                 ///< of the input
  std::vector<std::string> notes{};
};

/// Throws sdm::Error as sdm::uv_tiles and sdm::wrap_uvs do.
[[nodiscard]] std::vector<AtlasPart> atlas_parts(const sdm::Mesh& mesh, const sdm::AtlasOptions& options);
