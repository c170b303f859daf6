#include "map_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

namespace {

struct Kind {
  const char* name;
  bool MapFiles::*chosen;
  std::vector<std::string> files;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> kinds{
      {"exr", &MapFiles::exr, {"map.exr"}},
      {"png", &MapFiles::png, {"distance.png", "voronoi.png", "direction.png"}},
      {"glb", &MapFiles::glb, {"model.glb"}}};
  return kinds;
}

}  // namespace

std::vector<std::string> names(const MapFiles& files) {
  std::vector<std::string> names;
  for (const Kind& kind : kinds())
    if (files.*kind.chosen) names.insert(names.end(), kind.files.begin(), kind.files.end());
  return names;
}

std::string listed(const MapFiles& files) {
  std::string text;
  for (const std::string& name : names(files)) text += name + " ";
  return text;
}

void add_write_option(CLI::App& app, MapFiles& files) {
  std::vector<std::string> choices;
  for (const Kind& kind : kinds()) choices.emplace_back(kind.name);
  const std::string all = fmt::format("{}", fmt::join(choices, ","));
  choices.emplace_back("none");
  app.add_option_function<std::vector<std::string>>(
         "--write",
         [&files](const std::vector<std::string>& chosen) {
           if (chosen.size() > 1 && std::ranges::count(chosen, "none") > 0)
             throw CLI::ValidationError("--write", "none excludes the others");
           for (const Kind& kind : kinds()) files.*kind.chosen = std::ranges::count(chosen, kind.name) > 0;
         },
         "The files of a map to write: map.exr, the three pictures, model.glb; or none")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Validator(
          [choices](const std::string& text) {
            return std::ranges::count(choices, text) > 0
                       ? std::string()
                       : fmt::format("{} is not one of {}", text, fmt::join(choices, ", "));
          },
          ""))
      ->type_name("LIST")
      ->default_str(all);
}

void write_map_files(const std::filesystem::path& folder, const MapFiles& files, const sdm::Surface& surface,
                     const sdm::DistanceMap& map, std::span<const float> at_vertices,
                     const sdm::PictureOptions& picture, std::span<const std::uint8_t> boundary) {
  std::vector<std::function<void()>> work;
  if (files.exr) work.push_back([&] { sdm::write_exr(folder / "map.exr", surface, map, boundary); });
  if (files.glb)
    work.push_back([&] { sdm::write_glb(folder / "model.glb", surface, map, at_vertices, picture); });
  if (files.png) {
    work.push_back([&] { sdm::write_distance_png(folder / "distance.png", surface, map, picture); });
    work.push_back([&] { sdm::write_direction_png(folder / "direction.png", surface, map, picture); });
    work.push_back([&] { sdm::write_voronoi_png(folder / "voronoi.png", surface, map, picture); });
  }
  sdm::run_concurrently(work);
}
