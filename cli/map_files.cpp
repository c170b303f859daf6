#include "map_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "output_folder.h"

namespace {

struct Kind {
  const char* name;
  bool MapFiles::*chosen;
  bool of_one_input;  ///< not of the bodies of `sdm bodies`
  std::vector<std::string> files;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> kinds{
      {"views", &MapFiles::views, false, {"views.png"}},
      {"exr", &MapFiles::exr, false, {"map.exr"}},
      {"png", &MapFiles::png, false, {"atlas_distance.png", "atlas_voronoi.png", "atlas_direction.png"}},
      {"glb", &MapFiles::glb, false, {"model.glb"}},
      {"html", &MapFiles::html, true, {"report.html"}},
      {"texture", &MapFiles::texture, false, {"distance_texture.png", "distance_texture.json"}},
      {"ply", &MapFiles::ply, true, {"vertices.ply"}},
      {"csv", &MapFiles::csv, true, {"vertices.csv"}},
      {"npy", &MapFiles::npy, true, {"vertices.npy"}},
      {"vtp", &MapFiles::vtp, true, {"vertices.vtp"}}};
  return kinds;
}

/// Words of a list that must be among `choices`.
CLI::Validator one_of(const std::vector<std::string>& choices) {
  return CLI::Validator(
      [choices](const std::string& text) {
        return std::ranges::count(choices, text) > 0
                   ? std::string()
                   : fmt::format("{} is not one of {}", text, fmt::join(choices, ", "));
      },
      "");
}

std::string page_is_possible(const std::string& word) {
  if (word != "html" || sdm::can_write_html()) return {};
  return "html needs an sdm that was built with -DSDM_BUILD_REPORT=ON";
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

void add_write_option(CLI::App& app, MapFiles& files, bool of_one_input) {
  files.html = of_one_input && sdm::can_write_html();
  std::vector<std::string> choices, by_default;
  for (const Kind& kind : kinds()) {
    if (files.*kind.chosen) by_default.emplace_back(kind.name);
    const bool possible = kind.chosen != &MapFiles::html || sdm::can_write_html();
    if (possible && (of_one_input || !kind.of_one_input)) choices.emplace_back(kind.name);
  }
  std::string help =
      "The files of a map to write: views: views.png, O1 from six sides; exr: map.exr; png: three pictures "
      "of "
      "the atlas; glb: model.glb; texture: the distance as 16-bit grey; ";
  if (files.html) help += "html: report.html; ";
  if (of_one_input)
    help +=
        "ply, csv, npy, vtp: the distance at each vertex of the input, in its order, as vertices.ply and so "
        "on; ";
  add_write_option(app, choices, by_default, help + "or none",
                   [&files](const std::vector<std::string>& chosen) {
                     for (const Kind& kind : kinds())
                       files.*kind.chosen = std::ranges::count(chosen, kind.name) > 0;
                   });
}

void add_write_option(CLI::App& app, std::vector<std::string> choices,
                      const std::vector<std::string>& by_default, const std::string& help,
                      const std::function<void(const std::vector<std::string>&)>& set) {
  choices.emplace_back("none");
  app.add_option_function<std::vector<std::string>>(
         "--write",
         [set](const std::vector<std::string>& chosen) {
           if (chosen.size() > 1 && std::ranges::count(chosen, "none") > 0)
             throw CLI::ValidationError("--write", "none excludes the others");
           set(chosen);
         },
         help)
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Validator(page_is_possible, ""))
      ->check(one_of(choices))
      ->type_name("LIST")
      ->default_str(fmt::format("{}", fmt::join(by_default, ",")));
}

void add_channels_option(CLI::App& app, std::vector<std::string>& layers) {
  std::vector<std::string> on_request;
  for (const sdm::Channel& channel : sdm::channels())
    if (channel.on_request && (on_request.empty() || !on_request.back().starts_with(channel.layer)))
      on_request.push_back(fmt::format("{} ({})", channel.layer, channel.description));
  app.add_option("--channels", layers,
                 fmt::format("The layers of map.exr: {}, and on request {}", fmt::join(layers, ", "),
                             fmt::join(on_request, ", ")))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(one_of(sdm::channel_layers()))
      ->type_name("LIST")
      ->default_str(fmt::format("{}", fmt::join(layers, ",")));
}

std::vector<std::pair<std::string, std::string>> exr_attributes(const Input& on, const Input& to,
                                                                const sdm::DistanceMap& map,
                                                                const std::string& units) {
  return sdm::exr_attributes({.on = {.file = on.file, .transform = on.transform},
                              .to = {.file = to.file, .transform = to.transform}},
                             map, units);
}

void write_map_files(const std::filesystem::path& folder, const MapFiles& files, const sdm::Surface& surface,
                     const sdm::DistanceMap& map, std::span<const float> at_vertices, const sdm::Mesh* other,
                     const sdm::PictureOptions& picture, const sdm::PictureOptions& fixed,
                     const sdm::ExrOptions& exr) {
  std::vector<std::function<void()>> work;
  if (files.exr) work.push_back([&] { sdm::write_exr(folder / "map.exr", surface, map, exr); });
  if (files.glb)
    work.push_back([&] { sdm::write_glb(folder / "model.glb", surface, map, at_vertices, fixed); });
  if (files.png) {
    work.push_back([&] { sdm::write_distance_png(folder / "atlas_distance.png", surface, map, fixed); });
    work.push_back([&] { sdm::write_direction_png(folder / "atlas_direction.png", surface, map, fixed); });
    work.push_back([&] { sdm::write_voronoi_png(folder / "atlas_voronoi.png", surface, map, fixed); });
  }
  if (files.views)
    work.push_back(
        [&] { sdm::write_views_png(folder / "views.png", surface, map, at_vertices, other, fixed); });
  if (files.texture)
    work.push_back([&] {
      const char* name = "distance_texture.png";
      const sdm::TextureRange range = sdm::write_distance_texture(folder / name, surface, map, picture);
      sdm::write_texture_range(folder / "distance_texture.json", name, range, picture.units);
    });
  sdm::run_concurrently(work);
}

void write_report(const std::filesystem::path& folder, const MapFiles& files, const sdm::Surface& surface,
                  const sdm::DistanceMap& map, std::span<const float> at_vertices, const std::string& report,
                  const sdm::HtmlOptions& page) {
  if (files.html) sdm::write_html(folder / "report.html", surface, map, at_vertices, report, page);
  write_text(folder / "report.json", report);
}

void write_vertex_files(const std::filesystem::path& folder, const MapFiles& files,
                        const sdm::FileVertices& vertices, std::span<const float> at_vertices) {
  std::vector<std::function<void()>> work;
  const auto add = [&](bool chosen, const char* name, auto* write) {
    if (chosen) work.push_back([&, name, write] { write(folder / name, vertices, at_vertices); });
  };
  add(files.ply, "vertices.ply", sdm::write_vertices_ply);
  add(files.csv, "vertices.csv", sdm::write_vertices_csv);
  add(files.npy, "vertices.npy", sdm::write_vertices_npy);
  add(files.vtp, "vertices.vtp", sdm::write_vertices_vtp);
  sdm::run_concurrently(work);
}
