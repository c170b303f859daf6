#include "bake.h"

#include <fmt/format.h>
#include <sdm/bake_files.h>
#include <sdm/baked_geometry.h>
#include <sdm/threads.h>
#include <sdm/version.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "bake_options.h"
#include "bake_surface.h"
#include "cad_options.h"
#include "format.h"
#include "notes.h"
#include "output_folder.h"
#include "print.h"
#include "progress_line.h"
#include "report.h"
#include "stopwatch.h"
#include "unit_options.h"

namespace {

using Json = nlohmann::ordered_json;

struct BakeTimes {
  double import = 0, match = 0, bake = 0, output = 0, total = 0;
};

/// The numbers of texels that faces own, by how a point was found for them.
struct MatchCounts {
  std::size_t closest = 0, facing = 0, ray = 0, too_far = 0, facing_away = 0;

  [[nodiscard]] std::size_t matched() const { return closest + facing + ray; }
  [[nodiscard]] std::size_t unmatched() const { return too_far + facing_away; }
};

/// Tangent-space normals as a PNG, with what the model needs to be drawn with it.
struct NormalMap {
  std::vector<char> png{};  ///< empty: not asked for
  sdm::MeshAttribute normals{}, tangents{};
};

struct BakeResult {
  BakeSurface low{};
  MatchCounts matches{};
  std::vector<sdm::BakedTexture> textures{};
  NormalMap normal_map{};
  Notes notes{};
  BakeTimes time{};
};

MatchCounts counts_of(const sdm::TexelMatches& matches) {
  MatchCounts counts;
  for (const sdm::MatchKind kind : matches.kind) switch (kind) {
      case sdm::MatchKind::none:
        break;
      case sdm::MatchKind::closest:
        ++counts.closest;
        break;
      case sdm::MatchKind::facing:
        ++counts.facing;
        break;
      case sdm::MatchKind::ray:
        ++counts.ray;
        break;
      case sdm::MatchKind::too_far:
        ++counts.too_far;
        break;
      case sdm::MatchKind::facing_away:
        ++counts.facing_away;
    }
  return counts;
}

/// All files that any run of the command writes.
std::vector<std::filesystem::path> files_of_baking() {
  std::vector<std::filesystem::path> files{"report.json", "baked.glb"};
  for (const sdm::BakeChannel channel : sdm::kBakeChannels) files.emplace_back(picture_name(channel));
  files.emplace_back(fmt::format("{}.png", kNormalMap));
  return files;
}

void require_look(const Input& high) {
  const bool colors = std::ranges::count(high.look.attributes, "color", &sdm::MeshAttribute::name) > 0;
  if (high.look.materials.empty() && !colors)
    throw sdm::Error(fmt::format(
        "{} has neither materials nor colours of vertices, so there is nothing to bake", high.file));
}

std::array<Input, 2> load(const BakeCommand& command) {
  std::array<Input, 2> inputs;
  sdm::run_concurrently(
      {[&] {
         inputs[0] =
             load_input("high", command.high, command.transform_high, {false, command.tessellation, true});
         if (!command.channels || !command.channels->empty()) require_look(inputs[0]);
       },
       [&] {
         inputs[1] = load_input("low", command.low, command.transform_low, {false, command.tessellation});
       }});
  check_deflection(command.tessellation, {&inputs[0], &inputs[1]});
  return inputs;
}

std::vector<sdm::BakeChannel> channels_of(const BakeCommand& command, const Input& high,
                                          const sdm::MeshLook& look) {
  if (command.channels) return *command.channels;
  std::vector<sdm::BakeChannel> channels = sdm::varying_channels(high.mesh, look);
  if (std::ranges::count(channels, sdm::BakeChannel::base_color) == 0)
    channels.insert(channels.begin(), sdm::BakeChannel::base_color);
  return channels;
}

void check_matches(const BakeCommand& command, const MatchCounts& counts) {
  if (counts.matched() > 0) return;
  throw sdm::Error(fmt::format(
      "no point of {} is {}{} of {}: nothing can be baked; are both in the same place and in the same units?",
      command.high, counts.facing_away > 0 ? "on a face that faces a texel" : "close enough to a texel",
      counts.too_far > 0 ? fmt::format(" (--max-distance {})", number(command.map.max_distance)) : "",
      command.low));
}

/// Finds the points of HIGH, and decodes the pictures meanwhile.
sdm::TexelMatches match(const BakeCommand& command, const Input& high, const Input& low,
                        std::unique_ptr<sdm::Sites>& sites, std::vector<sdm::Image>& pictures,
                        BakeResult& result) {
  sdm::TexelMatches matches;
  const sdm::MeshLook look{high.look.materials, high.look.face_materials, {}, {}};
  const std::span<const sdm::BakeChannel> channels =
      command.channels ? std::span<const sdm::BakeChannel>(*command.channels) : sdm::kBakeChannels;
  sdm::run_concurrently(
      {[&] { pictures = sdm::decode_textures(high.look.textures, look, channels, result.notes); },
       [&] {
         sdm::run_concurrently({[&] { result.low = bake_surface(low, command.layout); },
                                [&] { sites = std::make_unique<sdm::Sites>(high.mesh); }});
         sdm::MatchOptions options = match_options(command);
         options.progress = command.map.progress;
         matches = sdm::match_texels(*result.low.surface, *sites, options);
       }});
  result.matches = counts_of(matches);
  check_matches(command, result.matches);
  return matches;
}

/// The normals of HIGH, those of its file if it has any, in the tangent space of LOW as it is drawn.
NormalMap normal_map_of(const BakeCommand& command, const Input& high, const sdm::Sites& sites,
                        const sdm::TexelMatches& matches, BakeResult& result) {
  constexpr double kCrease = 40;
  const sdm::Surface& surface = *result.low.surface;
  NormalMap map{.png = {}, .normals = sdm::smooth_normals(surface.mesh(), kCrease), .tangents = {}};
  map.tangents = sdm::tangents(surface, map.normals);
  const auto own = std::ranges::find(high.look.attributes, "normal", &sdm::MeshAttribute::name);
  const bool has_own = own != high.look.attributes.end();
  if (has_own && !command.transform_high.empty())
    result.notes.push_back(fmt::format(
        "{}: its normals are not moved by --transform-high; smooth ones are baked", command.high));
  std::vector<float> normals = sdm::matched_normals(
      surface, sites, matches,
      has_own && command.transform_high.empty() ? *own : sdm::smooth_normals(sites.mesh()));
  normals = sdm::tangent_space_normals(surface, map.normals, map.tangents, normals, command.map.progress);
  sdm::fill_texels(surface, 3, normals, true);
  map.png = sdm::encode_png(sdm::normal_map_image(surface, normals), false);
  return map;
}

void write_files(const BakeCommand& command, const BakeResult& result, const sdm::Material& material,
                 const std::filesystem::path& folder) {
  std::vector<std::function<void()>> work;
  for (const sdm::BakedTexture& texture : result.textures)
    work.emplace_back([&] {
      write_text(folder / picture_name(texture.channel), {texture.png.data(), texture.png.size()});
    });
  const NormalMap& normal_map = result.normal_map;
  const bool with_normals = !normal_map.png.empty();
  if (with_normals)
    work.emplace_back([&] {
      write_text(folder / fmt::format("{}.png", kNormalMap), {normal_map.png.data(), normal_map.png.size()});
    });
  work.emplace_back([&] {
    sdm::write_baked_glb(folder / "baked.glb", *result.low.surface, result.textures,
                         {.material = material,
                          .units = command.units,
                          .up = command.up,
                          .normals = with_normals ? &normal_map.normals : nullptr,
                          .normal_map = normal_map.png,
                          .tangents = with_normals ? &normal_map.tangents : nullptr});
  });
  sdm::run_concurrently(work);
}

/// Bakes, and writes all files but the report into `folder`.
BakeResult bake_into(const BakeCommand& command, const Input& high, const Input& low,
                     const std::filesystem::path& folder, ProgressLine& progress) {
  BakeResult result;
  Stopwatch watch;
  std::unique_ptr<sdm::Sites> sites;
  std::vector<sdm::Image> pictures;
  const sdm::TexelMatches matches = match(command, high, low, sites, pictures, result);
  result.time.match = watch.lap();

  const sdm::MeshLook look{high.look.materials, high.look.face_materials, pictures, high.look.attributes};
  const auto channels = channels_of(command, high, look);
  for (const sdm::BakedChannel& baked :
       sdm::bake(*result.low.surface, *sites, matches, look, channels, {.progress = command.map.progress}))
    result.textures.push_back(
        {baked.channel, sdm::encode_png(sdm::to_image(baked), is_color(baked.channel))});
  if (command.normal_map) result.normal_map = normal_map_of(command, high, *sites, matches, result);
  result.time.bake = watch.lap();

  progress.step("export");
  write_files(command, result, sdm::common_material(look), folder);
  result.time.output = watch.lap();
  Notes notes = notes_on(low, high);
  if (auto note = note_on_unit(command.units)) notes.push_back(std::move(*note));
  notes.insert(notes.end(), result.notes.begin(), result.notes.end());
  notes.insert(notes.end(), result.low.notes.begin(), result.low.notes.end());
  result.notes = std::move(notes);
  return result;
}

Json report_of(const BakeCommand& command, const Input& high, const Input& low, const BakeResult& result) {
  const sdm::Surface& surface = *result.low.surface;
  const MatchCounts& counts = result.matches;
  Json report{{"version", sdm::kVersion},
              {"high", to_json(high)},
              {"low", to_json(low)},
              {"units", command.units},
              {"atlas",
               {{"kind", sdm::name_of(surface.atlas_kind())},
                {"resolution", surface.resolution()},
                {"rows", surface.rows()},
                {"charts", surface.chart_count()},
                {"texels", surface.sample_texels().size()},
                {"utilisation", surface.utilisation()},
                {"overlapping_texels", surface.overlapping_texels()}}}};
  const bool limited = std::isfinite(command.map.max_distance);
  report["max_distance"] = limited ? Json(command.map.max_distance) : Json();
  const sdm::MatchOptions matching = match_options(command);
  const bool facing = matching.method != sdm::MatchMethod::closest;
  report["match"] = name_of(matching.method);
  report["facing"] = facing ? Json(matching.facing) : Json();
  report["cage"] = command.cage ? Json(*command.cage) : Json();
  report["texels"] = {{"closest", counts.closest},
                      {"facing", counts.facing},
                      {"ray", counts.ray},
                      {"too_far", counts.too_far},
                      {"facing_away", counts.facing_away}};
  Json& textures = report["textures"] = Json::object();
  for (const sdm::BakedTexture& texture : result.textures)
    textures[std::string(sdm::name_of(texture.channel))] = {
        {"file", picture_name(texture.channel)}, {"values", is_color(texture.channel) ? "sRGB" : "linear"}};
  if (!result.normal_map.png.empty())
    textures[kNormalMap] = {{"file", fmt::format("{}.png", kNormalMap)}, {"values", "tangent space"}};
  report["notes"] = result.notes;
  report["time_ms"] = {{"import", result.time.import},
                       {"match", result.time.match},
                       {"bake", result.time.bake},
                       {"export", result.time.output},
                       {"total", result.time.total}};
  return report;
}

std::string text_of(const BakeCommand& command, const BakeResult& result) {
  const sdm::Surface& surface = *result.low.surface;
  const MatchCounts& counts = result.matches;
  std::string text = fmt::format("{} -> {}\n", command.high, command.low);
  std::string names;
  for (const sdm::BakedTexture& texture : result.textures)
    names.append(names.empty() ? "" : ", ").append(sdm::name_of(texture.channel));
  const bool with_normals = !result.normal_map.png.empty();
  if (with_normals) names.append(names.empty() ? "" : ", ").append(kNormalMap);
  text += fmt::format("  baked     {}, {} x {} texels\n", names, surface.resolution(), surface.rows());
  text += fmt::format("  texels    {} have a point of HIGH{}\n", counts.matched(),
                      counts.facing + counts.ray > 0 ? " on a face that faces them" : "");
  if (counts.ray > 0)
    text += fmt::format("            {} of them by a ray along the normal of LOW\n", counts.ray);
  if (counts.too_far > 0)
    text += fmt::format("            {} are farther than --max-distance, and filled\n", counts.too_far);
  if (counts.facing_away > 0)
    text += fmt::format("            {} have no face that faces them, and are filled\n", counts.facing_away);
  text += note_lines(result.notes, 12);
  std::string files = "baked.glb ";
  for (const sdm::BakedTexture& texture : result.textures) files += picture_name(texture.channel) + " ";
  if (with_normals) files += fmt::format("{}.png ", kNormalMap);
  return text + result_lines(12, result.time.total, command.out.string(), files);
}

void run_baking(BakeCommand command) {
  Stopwatch total, watch;
  limit_threads(command.threads);
  OutputFolder out(command.out, files_of_baking);
  ProgressLine progress(command.quiet);
  command.layout.atlas.progress = command.map.progress = progress.callback();
  command.map.sign = sdm::SignMethod::none;

  progress.step("import");
  std::array<Input, 2> inputs = load(command);
  auto& [high, low] = inputs;
  const double import_ms = watch.lap();
  BakeResult result;
  Json report;
  out.fill([&] {
    result = bake_into(command, high, low, out.staging(), progress);
    inspect(high), inspect(low);
    result.time.import = import_ms, result.time.total = total.lap();
    report = report_of(command, high, low, result);
    write_text(out.staging() / "report.json", to_text(report));
  });
  print(
      command, [&] { return report; }, [&] { return text_of(command, result); });
}

}  // namespace

void add_bake_command(CLI::App& app) {
  CLI::App* bake = app.add_subcommand(
      "bake", "Bake the materials, textures and colours of a detailed mesh into textures of a coarse one");
  bake->footer(
      "Writes baked.glb (LOW with its textures), base_color.png and the pictures of other channels, and "
      "report.json.\n\n"
      "Example, a scan with colours onto a coarser copy of it:\n"
      "  sdm bake scan.glb low.glb -o asset --resolution 2048");
  const auto command = std::make_shared<BakeCommand>();
  add_options(*bake, *command);
  bake->callback([command] {
    if (command->layout.kind) {
      sdm::AtlasOptions atlas = command->layout.atlas;
      atlas.kind = *command->layout.kind;
      check_layout(atlas);
    }
    check_units(command->units, command->high, command->transform_high);
    check_units(command->units, command->low, command->transform_low);
    (void)match_options(*command);
    run_baking(*command);
  });
}
