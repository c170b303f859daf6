// The materials of polygons.
#pragma once

#include <sdm/material.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace sdm::io {

/// The materials of a file, with their textures.
struct PolygonMaterials {
  /// A material of the polygons from one on, until another run begins.
  struct Run {
    std::uint32_t first_polygon, material;  ///< index into list, or kNone
  };

  std::vector<Material> list;
  std::vector<TextureFile> textures;
  std::vector<Run> runs;

  /// Returns the texture in a file below the folder, which is read once, whatever its names. Throws as
  /// read_below().
  std::uint32_t texture_in_file(const std::filesystem::path& folder, const std::string& name);

  /// Whether a fault was not seen before: one note for each is enough.
  bool is_new_fault(std::string_view fault) { return faults.emplace(fault).second; }

  std::map<std::filesystem::path, std::uint32_t> files;  ///< the textures that were read
  std::set<std::string, std::less<>> faults;
};

}  // namespace sdm::io
