#include "bake_options.h"

#include <fmt/format.h>
#include <sdm/baked_geometry.h>

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
  return names + ", " + kNormalMap;
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

void add_channels(CLI::App& app, std::optional<std::vector<sdm::BakeChannel>>& channels, bool& normal_map) {
  app.add_option_function<std::vector<std::string>>(
         "--channels",
         [&](const std::vector<std::string>& names) {
           channels.emplace();
           normal_map = std::ranges::count(names, kNormalMap) > 0;
           for (const sdm::BakeChannel channel : sdm::kBakeChannels)
             if (std::ranges::count(names, std::string(sdm::name_of(channel))) > 0)
               channels->push_back(channel);
         },
         fmt::format("The textures to bake, of {}; by default base_color, and others that HIGH has a texture "
                     "for or that differ between its materials. normal: the shape of HIGH, in tangent space",
                     channel_names()))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Validator(
          [](const std::string& name) {
            if (name == kNormalMap && !sdm::has_tangents())
              return std::string("normal needs MikkTSpace, which this build does not have");
            return channel_of(name) || name == kNormalMap
                       ? std::string()
                       : fmt::format("{} is not one of {}", name, channel_names());
          },
          ""))
      ->type_name("LIST");
}

void add_matching(CLI::App& app, BakeCommand& c) {
  add_choice<std::optional<sdm::MatchMethod>>(
      app, "--match", c.match,
      "Which point of HIGH belongs to a texel: the closest one, the closest one that faces the same way (as "
      "--facing), or the nearest hit along the normal of LOW that does, where there is one; auto: closest, "
      "or "
      "facing if --facing is given",
      {{"auto", std::nullopt},
       {"closest", sdm::MatchMethod::closest},
       {"facing", sdm::MatchMethod::facing},
       {"ray", sdm::MatchMethod::ray}});
  app.add_option("--cage", c.cage, "How far --match ray searches along the normal, to either side")
      ->check(positive_number())
      ->type_name("D");
}

}  // namespace

sdm::MatchOptions match_options(const BakeCommand& command) {
  const sdm::MapOptions& map = command.map;
  const sdm::MatchMethod method =
      command.match.value_or(map.facing ? sdm::MatchMethod::facing : sdm::MatchMethod::closest);
  if (map.facing && method == sdm::MatchMethod::closest)
    throw CLI::ValidationError("--facing", "does not apply to --match closest");
  if (command.cage && method != sdm::MatchMethod::ray)
    throw CLI::ValidationError("--cage", "applies to --match ray");
  sdm::MatchOptions options{.method = method, .max_distance = map.max_distance};
  if (map.facing) options.facing = *map.facing;
  if (command.cage) options.cage = *command.cage;
  return options;
}

std::string name_of(sdm::MatchMethod method) {
  switch (method) {
    case sdm::MatchMethod::closest:
      break;
    case sdm::MatchMethod::facing:
      return "facing";
    case sdm::MatchMethod::ray:
      return "ray";
  }
  return "closest";
}

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
  add_channels(app, c.channels, c.normal_map);
  app.add_option("--max-distance", c.map.max_distance,
                 "Texels farther than this from HIGH have no match, and are filled from others")
      ->check(positive_number())
      ->type_name("D");
  add_facing_option(app, c.map.facing, "texel's face", "HIGH");
  add_matching(app, c);
  app.add_option("--units", c.units, "Units of the meshes; m, cm, mm, um, in, ft scale baked.glb to metres")
      ->type_name("NAME");
  add_up_option(app, c.up, "baked.glb");
  add_run_options(app, c, "the report (report.json) instead of a summary");
}
