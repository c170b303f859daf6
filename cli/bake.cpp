#include "bake.h"

#include <fmt/format.h>
#include <sdm/bake_files.h>
#include <sdm/execution.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "bake_channels.h"
#include "bake_options.h"
#include "bake_report.h"
#include "bake_surface.h"
#include "cad_options.h"
#include "format.h"
#include "output_folder.h"
#include "print.h"
#include "progress_line.h"
#include "src/core/stopwatch.h"
#include "unit_options.h"

namespace {

using Json = nlohmann::ordered_json;

/// The files that are written whatever is baked.
std::vector<std::filesystem::path> planned_files(const BakeCommand& command) {
  std::vector<std::filesystem::path> files{"report.json", "baked.glb"};
  if (command.page) files.emplace_back("report.html");
  return files;
}

void require_look(const Input& high) {
  const bool colors = std::ranges::count(high.look.attributes, "color", &sdm::MeshAttribute::name) > 0;
  if (high.look.materials.empty() && !colors)
    throw sdm::Error(fmt::format(
        "{} has neither materials nor colours of vertices, so there is nothing to bake but its shape, as "
        "--channels normal or displacement does{}{}",
        high.file, high.notes.empty() ? "" : "; ", fmt::join(high.notes, "; ")));
}

std::array<Input, 2> load(const BakeCommand& command) {
  std::array<Input, 2> inputs;
  sdm::run_concurrently(
      {[&] {
         inputs[0] =
             load_input("high", command.high, command.transform_high, {false, command.tessellation, true});
         if (!command.request.channels || !command.request.channels->look.empty()) require_look(inputs[0]);
       },
       [&] {
         inputs[1] = load_input("low", command.low, command.transform_low, {false, command.tessellation});
       }});
  check_deflection(command.tessellation, {&inputs[0], &inputs[1]});
  return inputs;
}

void check_matches(const BakeCommand& command, const sdm::MatchCounts& counts) {
  if (counts.matched() > 0) return;
  throw sdm::Error(fmt::format(
      "no point of {} is {}{} of {}: nothing can be baked; are both in the same place and in the same units?",
      command.high, counts.facing_away > 0 ? "on a face that faces a texel" : "close enough to a texel",
      counts.too_far > 0 ? fmt::format(" (--max-distance {})", number(command.request.max_distance)) : "",
      command.low));
}

/// What is known of HIGH besides its file.
struct Detailed {
  std::unique_ptr<sdm::Sites> sites{};
  std::vector<sdm::Image> pictures{};
  std::optional<sdm::MeshAttribute> smooth_normals{};
  const sdm::MeshAttribute* normals = nullptr;  ///< those of its file, or the smooth ones; null: not needed
};

bool bakes_directions(const BakeCommand& command) {
  return command.request.channels &&
         std::ranges::any_of(command.request.channels->geometry, sdm::is_direction);
}

/// The normals of HIGH that are baked and shown: those of its file, unless it was moved.
void find_normals(const BakeCommand& command, const Input& high, Detailed& detailed) {
  const auto own = std::ranges::find(high.look.attributes, "normal", &sdm::MeshAttribute::name);
  if (own != high.look.attributes.end() && command.transform_high.empty()) {
    detailed.normals = &*own;
    return;
  }
  if (!command.page && !bakes_directions(command)) return;
  detailed.smooth_normals = sdm::smooth_normals(high.mesh);
  detailed.normals = &*detailed.smooth_normals;
}

/// All that is known of HIGH without LOW. Its mesh moves into the sites.
void prepare(const BakeCommand& command, Input& high, Detailed& detailed) {
  inspect(high);
  find_normals(command, high, detailed);
  detailed.sites = std::make_unique<sdm::Sites>(std::move(high.mesh));
}

/// Finds the points of HIGH. Decodes its pictures meanwhile.
sdm::TexelMatches match(const BakeCommand& command, Input& high, Input& low, Detailed& detailed,
                        BakeResult& result) {
  const sdm::MeshLook look{high.look.materials, high.look.face_materials, {}, {}};
  const std::span<const sdm::BakeChannel> channels =
      command.request.channels ? std::span<const sdm::BakeChannel>(command.request.channels->look)
                               : sdm::kBakeChannels;
  const auto decode = [&] {
    try {
      detailed.pictures =
          sdm::decode_textures(high.look.textures, look, channels, result.notes, bakes_directions(command));
    } catch (const sdm::Cancelled&) {
      throw;
    } catch (const sdm::Error& error) {
      throw sdm::Error(fmt::format("{}: {}", high.file, error.what()));
    }
  };
  const auto lay_out = [&] {
    result.low = bake_surface(low, command.request);
    inspect(low);
  };
  sdm::TexelMatches matches;
  const auto find = [&] {
    sdm::run_concurrently({lay_out, [&] { prepare(command, high, detailed); }});
    matches = sdm::match_texels(*result.low.surface, *detailed.sites, sdm::match_options(command.request));
  };
  sdm::run_concurrently({decode, find});
  result.matches = matches.counts();
  check_matches(command, result.matches);
  return matches;
}

sdm::BakedModelOptions model_options(const BakeCommand& command, const BakeResult& result,
                                     const sdm::MeshLook& look) {
  const NormalMap& map = result.channels.normal_map;
  const bool has_map = !map.png.empty();
  return {.material = sdm::common_material(look),
          .units = command.units,
          .up = command.up,
          .normals = has_map ? &map.normals : nullptr,
          .normal_map = map.png,
          .tangents = has_map ? &map.tangents : nullptr};
}

/// Bakes, and writes all files into `folder`. Returns the report.
Json bake_into(const BakeCommand& command, Input& high, Input& low, const std::filesystem::path& folder,
               ProgressLine& progress, BakeResult& result) {
  sdm::Stopwatch watch;
  Detailed detailed;
  const sdm::TexelMatches matches = match(command, high, low, detailed, result);
  result.time.match = watch.lap();

  const sdm::Surface& surface = *result.low.surface;
  const sdm::MeshLook look{high.look.materials, high.look.face_materials, detailed.pictures,
                           high.look.attributes};
  std::optional<sdm::DetailedView> view;
  sdm::run_concurrently(
      {[&] {
         result.channels =
             bake_channels({command, high, *detailed.sites, surface, matches, look, detailed.normals}, folder,
                           result.notes);
       },
       [&] {
         if (command.page)
           view.emplace(sdm::BakedFrom{detailed.sites->mesh(), look, detailed.normals}, surface.mesh());
       }});
  result.time.bake = watch.lap();

  progress.step("export");
  sdm::BakedModelOptions model = model_options(command, result, look);
  sdm::write_baked_glb(folder / "baked.glb", surface, result.channels.textures, model);
  result.time.output = watch.lap();
  result.time.total = result.time.import + result.time.match + result.time.bake + result.time.output;
  Notes notes = notes_on(low, high);
  if (auto note = note_on_unit(command.units)) notes.push_back(std::move(*note));
  notes.insert(notes.end(), result.notes.begin(), result.notes.end());
  notes.insert(notes.end(), result.low.notes.begin(), result.low.notes.end());
  result.notes = std::move(notes);
  Json report = report_of(command, high, low, result);
  if (view) {
    model.normal_map = result.channels.page_normal_map;
    sdm::write_baked_html(folder / "report.html", surface, result.channels.page_textures, model, *view,
                          to_text(report));
  }
  write_text(folder / "report.json", to_text(report));
  return report;
}

/// Throws CLI::ValidationError for options that exclude each other.
void check_request(const sdm::BakeRequest& request) try {
  const sdm::AtlasOptions layout = sdm::sample_layout(request);
  if (request.atlas) check_layout(layout);
  (void)sdm::match_options(request);
} catch (const sdm::Error& error) {
  throw CLI::ValidationError(error.what());
}

void run_baking(BakeCommand command) {
  sdm::Stopwatch watch;
  limit_threads(command.threads);
  OutputFolder out(command.out, {.command = "bake", .planned = planned_files(command)});
  ProgressLine progress(command.quiet);
  command.request.progress = progress.callback();

  progress.step("import");
  std::array<Input, 2> inputs = load(command);
  auto& [high, low] = inputs;
  BakeResult result;
  result.time.import = watch.lap();
  Json report;
  out.fill([&] { report = bake_into(command, high, low, out.staging(), progress, result); });
  print(
      command, [&] { return report; }, [&] { return text_of(command, result); });
}

}  // namespace

void add_bake_command(CLI::App& app) {
  CLI::App* bake = app.add_subcommand(
      "bake", "Bake the materials, textures and colours of a detailed mesh into textures of a coarse one");
  bake->footer(
      "Writes baked.glb (LOW with its textures), a file for each channel, such as base_color.png, "
      "report.json, "
      "and report.html, a page that shows LOW beside HIGH.\n\n"
      "Example, a scan with colours onto a coarser copy of it:\n"
      "  sdm bake scan.glb low.glb -o asset --resolution 2048");
  const auto command = std::make_shared<BakeCommand>();
  add_options(*bake, *command);
  bake->callback([command] {
    check_request(command->request);
    check_units(command->units, command->high, command->transform_high);
    check_units(command->units, command->low, command->transform_low);
    run_baking(*command);
  });
}
