#include "io/mesh/polygons/polygon_materials.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/excerpt.h"
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

void PolygonMaterials::leave_out(std::string_view what, std::string_view material, std::string_view why) {
  const auto [known, is_new] =
      left_out_of.try_emplace({std::string(what), std::string(why)}, left_out.size());
  if (is_new) left_out.push_back({.what = std::string(what), .why = std::string(why), .materials = {}});
  std::vector<std::string>& materials = left_out[known->second].materials;
  if (materials.empty() || materials.back() != material) materials.emplace_back(material);
}

void PolygonMaterials::move_notes(std::vector<std::string>& notes) {
  for (const LeftOut& o : left_out)
    notes.push_back(fmt::format("{} of the material{} {} is left out: {}", o.what,
                                o.materials.size() == 1 ? "" : "s", first_of(o.materials), o.why));
  left_out.clear();
  left_out_of.clear();
}

std::string first_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i)
    text += (i == 0 ? "" : ", ") + excerpt(names[i]);
  if (names.size() > kMost) text += fmt::format(" and {} more", names.size() - kMost);
  return text;
}

}  // namespace sdm::io
