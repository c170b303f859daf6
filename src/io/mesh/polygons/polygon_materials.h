// The materials of polygons.
#pragma once

#include <sdm/material.h>

#include <cstdint>
#include <vector>

namespace sdm::io {

/// The materials of a file, with their textures.
struct PolygonMaterials {
  /// From one polygon on, until another run begins.
  struct Run {
    std::uint32_t first_polygon, material;  ///< index into list, or kNone
  };

  std::vector<Material> list;
  std::vector<TextureFile> textures;
  std::vector<Run> runs;
};

}  // namespace sdm::io
