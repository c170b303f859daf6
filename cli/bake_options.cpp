#include "bake_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sdm/baked_geometry.h>
#include <sdm/error.h>
#include <sdm/supersampling.h>

#include <algorithm>

#include "cad_options.h"
#include "declared_options.h"
#include "option_checks.h"

namespace {

std::vector<std::string> channel_names() {
  std::vector<std::string> names;
  for (const sdm::BakeChannel channel : sdm::kBakeChannels) names.emplace_back(sdm::name_of(channel));
  for (const sdm::GeometryChannel channel : sdm::kGeometryChannels) names.emplace_back(sdm::name_of(channel));
  return names;
}

/// Those of the names, in the order of the library.
BakeSelection selected(const std::vector<std::string>& names) {
  const auto add = [&](const auto& channels, auto& to) {
    for (const auto channel : channels)
      if (std::ranges::count(names, std::string(sdm::name_of(channel))) > 0) to.push_back(channel);
  };
  BakeSelection selection;
  add(sdm::kBakeChannels, selection.look), add(sdm::kGeometryChannels, selection.geometry);
  return selection;
}

std::string check_channel(const std::string& name) {
  if (name == sdm::name_of(sdm::GeometryChannel::normal) && !sdm::has_tangents())
    return "normal needs MikkTSpace, which this build does not have";
  const auto names = channel_names();
  if (std::ranges::count(names, name) > 0) return {};
  return fmt::format("{} is not one of {}", name, fmt::join(names, ", "));
}

/// Nothing if there are not as many samples of a texel.
std::optional<std::uint32_t> side_of(const std::string& text) {
  const auto samples = parse_whole_number(text);
  return samples ? sdm::sample_side(*samples) : std::nullopt;
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

void add_channels(CLI::App& app, BakeCommand& c) {
  app.add_option_function<std::vector<std::string>>(
         "--channels", [&c](const std::vector<std::string>& names) { c.channels = selected(names); },
         fmt::format("What to bake, of {}; by default base_color, and others that HIGH has a texture for or "
                     "that differ between its materials. normal: the shape of HIGH, in tangent space",
                     fmt::join(channel_names(), ", ")))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Validator(check_channel, ""))
      ->type_name("LIST");
  app.add_option("--occlusion-rays", c.occlusion.rays, "Of ambient_occlusion: rays from each point of HIGH")
      ->transform(whole_number(1, 65536))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--occlusion-distance", c.occlusion.max_distance,
                 "Of ambient_occlusion: what is farther away occludes nothing")
      ->check(positive_number())
      ->type_name("D");
  add_choice(
      app, "--thickness-method", c.thickness,
      "Of thickness: the diameter of the largest ball in HIGH that touches the point, or the length of the "
      "ray along the inward normal");
}

void add_samples(CLI::App& app, BakeCommand& c) {
  app.add_option_function<std::string>(
         "--samples", [&c](const std::string& text) { c.sample_side = *side_of(text); },
         "Samples in each texel, the square of 1 to 8: each has a point of HIGH, and the texel has their "
         "mean")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return side_of(text) ? std::string() : text + " is not one of 1, 4, 9, 16, 25, 36, 49, 64";
          },
          ""))
      ->type_name("N")
      ->default_str("1");
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

BakeLayout sample_layout(const BakeCommand& command) {
  return {command.layout.kind, sdm::sample_layout(command.layout.atlas, command.sample_side)};
}

void check_samples(const BakeCommand& command) {
  try {
    (void)sample_layout(command);
  } catch (const sdm::Error& error) {
    throw CLI::ValidationError("--samples", error.what());
  }
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
  add_channels(app, c);
  add_samples(app, c);
  add_declared_options(
      app, c.map, {"sign"},
      {{"max_distance", "Texels farther than this from HIGH have no match, and are filled from others."},
       {"facing",
        "Match the closest of the faces of HIGH that face the same way: whose normal is within this angle of "
        "that of the texel's face. For thin walls, where the closest point may be on the other skin."}});
  add_matching(app, c);
  app.add_option("--units", c.units, "Units of the meshes; m, cm, mm, um, in, ft scale baked.glb to metres")
      ->type_name("NAME");
  add_up_option(app, c.up, "baked.glb");
  app.add_flag("!--no-page", c.page, "Do not write report.html");
  add_run_options(app, c, "the report (report.json) instead of a summary");
}
