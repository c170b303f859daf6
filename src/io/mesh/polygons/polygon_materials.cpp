#include "io/mesh/polygons/polygon_materials.h"

#include "io/file/file_below.h"

namespace sdm::io {

std::uint32_t PolygonMaterials::texture_in_file(const std::filesystem::path& folder,
                                                const std::string& name) {
  const std::filesystem::path file = file_below(folder, name, "texture");
  if (const auto known = files.find(file); known != files.end()) return known->second;
  const FileBytes bytes = read_below(folder, name, "texture");
  textures.push_back({.name = name, .bytes = {bytes.view().begin(), bytes.view().end()}});
  return files[file] = static_cast<std::uint32_t>(textures.size() - 1);
}

}  // namespace sdm::io
