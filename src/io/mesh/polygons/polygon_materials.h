// The materials of polygons.
#pragma once

#include <sdm/mesh_attributes.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
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

  /// Notes that something of a material is left out, such as "Kd". Materials that have the same left out for
  /// the same reason share a note.
  void leave_out(std::string_view what, std::string_view material, std::string_view why);
  /// Moves these notes to others.
  void move_notes(std::vector<std::string>& notes);

  struct LeftOut {
    std::string what, why;
    std::vector<std::string> materials;
  };

  std::map<std::filesystem::path, std::uint32_t> files;  ///< the textures that were read
  std::vector<LeftOut> left_out;
  std::map<std::pair<std::string, std::string>, std::size_t> left_out_of;  ///< the item of what, and why
};

/// The first three of some names of a file, for messages, and how many there are more.
[[nodiscard]] std::string first_of(const std::vector<std::string>& names);

}  // namespace sdm::io
