#include "bake_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "cad_options.h"
#include "facing.h"
#include "option_checks.h"

namespace {

std::optional<sdm::BakeChannel> channel_of(const std::string& name) {
  const auto* const found = std::ranges::find(
      sdm::kBakeChannels, name, [](sdm::BakeChannel channel) { return std::string(sdm::name_of(channel)); });
  return found == std::end(sdm::kBakeChannels) ? std::nullopt : std::optional(*found);
}

std::string channel_names() {
  std::string names;
  for (const sdm::BakeChannel channel : sdm::kBakeChannels)
    names.append(names.empty() ? "" : ", ").append(sdm::name_of(channel));
  return names;
}

void add_layout(CLI::App& app, BakeLayout& layout) {
  add_resolution_option(app, layout.atlas, "the textures");
  add_choice<std::optional<sdm::AtlasKind>>(
      app, "--atlas", layout.kind,
      "How LOW is parametrised: by its own UVs, in few charts, or in pairs of triangles without distortion; "
      "auto: by its UVs if they lie in [0, 1] and faces do not overlap there, otherwise in charts",
      {{"auto", std::nullopt},
       {"uv", sdm::AtlasKind::uv},
       {"charts", sdm::AtlasKind::charts},
       {"triangles", sdm::AtlasKind::triangles}});
  app.add_option("--gutter", layout.atlas.gutter,
                 "Free texels around each chart, and how far values extend beyond charts, if more than 4")
      ->transform(whole_number(0, 8192))
      ->type_name("N")
      ->capture_default_str();
}

void add_channels(CLI::App& app, std::optional<std::vector<sdm::BakeChannel>>& channels) {
  app.add_option_function<std::vector<std::string>>(
         "--channels",
         [&channels](const std::vector<std::string>& names) {
           channels.emplace();
           for (const sdm::BakeChannel channel : sdm::kBakeChannels)
             if (std::ranges::count(names, std::string(sdm::name_of(channel))) > 0)
               channels->push_back(channel);
         },
         fmt::format("The textures to bake, of {}; by default base_color, and others that HIGH has a texture "
                     "for or that differ between its materials",
                     channel_names()))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Validator(
          [](const std::string& name) {
            return channel_of(name) ? std::string()
                                    : fmt::format("{} is not one of {}", name, channel_names());
          },
          ""))
      ->type_name("LIST");
}

}  // namespace

std::string picture_name(sdm::BakeChannel channel) {
  return std::string(sdm::name_of(channel)) + ".png";
}

void add_options(CLI::App& app, BakeCommand& c) {
  app.add_option("HIGH", c.high,
                 fmt::format("The mesh with materials, textures or colours ({})", sdm::mesh_format_names()))
      ->required();
  app.add_option("LOW", c.low, "The mesh that gets the textures")->required();
  add_output_option(app, c.out);
  add_transform_option(app, "--transform-high", "HIGH", c.transform_high);
  add_transform_option(app, "--transform-low", "LOW", c.transform_low);
  add_deflection_option(app, c.tessellation);
  add_layout(app, c.layout);
  add_channels(app, c.channels);
  app.add_option("--max-distance", c.map.max_distance,
                 "Texels farther than this from HIGH have no match, and are filled from others")
      ->check(positive_number())
      ->type_name("D");
  add_facing_option(app, c.map.facing, "texel's face", "HIGH");
  app.add_option("--units", c.units, "Units of the meshes; m, cm, mm, um, in, ft scale baked.glb to metres")
      ->type_name("NAME");
  add_up_option(app, c.up, "baked.glb");
  add_run_options(app, c, "the report (report.json) instead of a summary");
}
