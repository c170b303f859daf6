#include "simplify.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>
#include <sdm/simplify.h>
#include <sdm/version.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bounds_text.h"
#include "cad_options.h"
#include "common_options.h"
#include "declared_options.h"
#include "format.h"
#include "notes.h"
#include "option_checks.h"
#include "output_folder.h"
#include "print.h"
#include "progress_line.h"
#include "report.h"
#include "src/core/stopwatch.h"
#include "src/io/json/report_json.h"
#include "unit_options.h"
#include "weld.h"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct SimplifyCommand : RunOptions {
  std::string mesh, units;
  fs::path out, report;  // empty: no report
  sdm::LevelsOptions levels;
  std::optional<double> percent;  ///< of the triangles of the mesh, in place of levels.triangles
  std::optional<sdm::WeldOptions> weld;
  sdm::TessellationOptions tessellation;

  /// The file of a level of detail; 0 is the finest.
  [[nodiscard]] fs::path file(std::size_t level) const {
    if (level == 0) return out;
    return out.parent_path() /
           fmt::format("{}_lod{}{}", out.stem().string(), level, out.extension().string());
  }
};

/// What a level has besides its geometry.
struct LevelExtras {
  std::vector<sdm::MeshAttribute> attributes;
  std::vector<std::uint32_t> face_materials;
  std::vector<sdm::FaceNames> names;
};

struct SimplifyOutcome : sdm::SimplifiedLevels {
  Input input;
  std::vector<LevelExtras> extras;             ///< of the levels
  std::size_t triangles = 0;                   ///< of the input
  std::optional<std::uint64_t> max_triangles;  ///< that are asked for
  Notes notes;
  double import_ms = 0, output_ms = 0;
};

/// A sentence on a level that does not have what was asked for.
std::optional<std::string> note_on_level(const SimplifyCommand& command, std::size_t level,
                                         const sdm::Simplified& simplified) {
  if (!simplified.stopped) return std::nullopt;
  const std::string file = command.file(level).string();
  const std::string same = level == 0 ? "the mesh itself, with all its triangles" : "the level before it";
  if (command.levels.max_deviation)
    return fmt::format("{} is {}: no mesh with fewer triangles was found that keeps the deviation within {}",
                       file, same,
                       number(*command.levels.max_deviation * std::ldexp(1, static_cast<int>(level))));
  return fmt::format(
      "{} has {} triangles, more than asked for: borders, seams, UVs and non-manifold edges permit no "
      "further collapse, or nothing with an area would be left",
      file, simplified.mesh.triangles.size());
}

/// What files of a format keep of faces.
struct Kept {
  bool attributes = false, materials = false;
  std::vector<std::string> names{};  ///< kinds
};

Kept kept_in(const fs::path& file) {
  const std::string extension = file.extension().string();
  if (extension.size() != 4) return {};
  switch (std::tolower(static_cast<unsigned char>(extension[1]))) {
    case 'o':
      return {true, true, {"object", "group", "material"}};
    case 'g':
      return {true, true, {"object"}};
    case 'p':
      return {.attributes = true};
    default:
      return {};
  }
}

/// Leaves out of the input what the format does not keep, and notes it.
void leave_out(Input& input, const Kept& kept, const fs::path& file, Notes& notes) {
  if (!kept.materials && !input.look.materials.empty()) {
    notes.push_back(
        fmt::format("{} has no materials, which {} has: .glb and .obj keep them", file.string(), input.file));
    input.look.materials.clear();
    input.look.face_materials.clear();
  }
  if (!kept.attributes) input.look.attributes.clear();
  std::erase_if(input.names,
                [&](const sdm::FaceNames& names) { return std::ranges::count(kept.names, names.kind) == 0; });
}

/// What the levels have of the normals, colours, materials and names of the input.
void carry(SimplifyOutcome& outcome, const sdm::Progress& progress) {
  const Input& input = outcome.input;
  std::optional<sdm::Sites> sites;
  if (!input.look.attributes.empty()) sites.emplace(input.mesh);
  for (const sdm::Simplified& level : outcome.levels) {
    LevelExtras& extras = outcome.extras.emplace_back();
    if (sites)
      extras.attributes = sdm::carried_attributes(*sites, input.look.attributes, level.mesh, progress);
    if (level.source_faces.empty()) continue;
    extras.names = sdm::names_of_part(input.names, level.source_faces);
    if (!input.look.face_materials.empty())
      for (const std::uint32_t face : level.source_faces)
        extras.face_materials.push_back(input.look.face_materials[face]);
  }
}

SimplifyOutcome simplify_mesh(const SimplifyCommand& command, const sdm::Progress& progress) {
  sdm::Stopwatch watch;
  SimplifyOutcome outcome;
  outcome.input =
      load_input("mesh", command.mesh, "", {.tessellation = command.tessellation, .attributes = true});
  check_deflection(command.tessellation, {&outcome.input});
  if (command.weld) weld(outcome.input, *command.weld);
  if (command.json || !command.report.empty()) inspect(outcome.input);
  outcome.triangles = outcome.input.mesh.triangles.size();
  outcome.notes = outcome.input.notes;
  leave_out(outcome.input, kept_in(command.out), command.out, outcome.notes);
  if (auto note = note_on_unit(command.units)) outcome.notes.push_back(std::move(*note));
  outcome.import_ms = watch.lap();
  sdm::LevelsOptions options = command.levels;
  if (command.percent)
    options.triangles = std::max<std::uint64_t>(
        1, static_cast<std::uint64_t>(*command.percent * static_cast<double>(outcome.triangles) / 100));
  outcome.max_triangles = options.triangles;
  options.single_precision = sdm::is_written_in_single_precision(command.out);
  options.progress = progress;
  std::vector<std::uint32_t> regions;
  if (!outcome.input.look.face_materials.empty() || !outcome.input.names.empty())
    regions = sdm::face_regions(outcome.triangles, outcome.input.look.face_materials, outcome.input.names);
  options.regions = regions;
  try {
    static_cast<sdm::SimplifiedLevels&>(outcome) = sdm::simplify_levels(outcome.input.mesh, options);
    carry(outcome, progress);
  } catch (const sdm::Cancelled&) {
    throw;
  } catch (const sdm::Error& error) {
    throw sdm::Error(fmt::format("{}: {}", command.mesh, error.what()));
  }
  for (std::size_t i = 0; i < outcome.levels.size(); ++i)
    if (auto note = note_on_level(command, i, outcome.levels[i])) outcome.notes.push_back(std::move(*note));
  return outcome;
}

Json level_json(const SimplifyCommand& command, std::size_t level, const sdm::Simplified& simplified) {
  Json json{{"file", command.file(level).string()}};
  json.update(sdm::to_json(simplified));
  return json;
}

Json report_of(const SimplifyCommand& command, const SimplifyOutcome& outcome) {
  Json json;
  json["version"] = sdm::kVersion;
  json["mesh"] = to_json(outcome.input);
  json["units"] = command.units;
  const std::optional<double>& deviation = command.levels.max_deviation;
  json["max_deviation"] = deviation ? Json(*deviation) : Json();
  json["max_triangles"] = outcome.max_triangles ? Json(*outcome.max_triangles) : Json();
  json["levels"] = Json::array();
  for (std::size_t i = 0; i < outcome.levels.size(); ++i)
    json["levels"].push_back(level_json(command, i, outcome.levels[i]));
  json["settings"] = sdm::settings_json(command.levels);
  json["candidates"] = outcome.report.candidates;
  json["notes"] = outcome.notes;
  json["time_ms"] = {{"import", outcome.import_ms},
                     {"sites", outcome.report.sites_ms},
                     {"collapse", outcome.report.collapse_ms},
                     {"deviation", outcome.report.deviation_ms},
                     {"output", outcome.output_ms}};
  return json;
}

std::string summary(const SimplifyCommand& command, const SimplifyOutcome& outcome) {
  std::string text = fmt::format("{}: {} triangles\n", command.mesh, outcome.triangles);
  const std::string unit = unit_suffix(command.units);
  for (std::size_t i = 0; i < outcome.levels.size(); ++i) {
    const sdm::Simplified& level = outcome.levels[i];
    const std::size_t count = level.mesh.triangles.size();
    const sdm::BoundedLength& d = level.deviation;
    text += fmt::format("  result     {}: {} triangles, {} %\n", command.file(i).string(), count,
                        number(100 * static_cast<double>(count) / static_cast<double>(outcome.triangles), 3));
    const std::string between =
        d.certainty == sdm::Certainty::exact ? std::string() : "  " + bounds_text(d.lower, d.upper);
    text +=
        fmt::format("  deviation  {}{}{} ({})\n", number(d.value), unit, between, sdm::name_of(d.certainty));
    text += fmt::format("  estimate   {}{}, of the collapses, no bound\n", number(level.estimate), unit);
  }
  return text + note_lines(outcome.notes, 13);
}

/// Whether both name one file. Pipes and devices, whose links lead to no path, are none.
bool name_one_file(const fs::path& a, const fs::path& b) {
  if (fs::exists(a) && !fs::is_regular_file(a)) return false;
  return fs::weakly_canonical(a) == fs::weakly_canonical(b);
}

/// Writes the report, together with the meshes if it is a file beside them; otherwise before them.
void write_report(const SimplifyCommand& command, const SimplifyOutcome& outcome, OutputFolder& out) {
  const fs::path folder = fs::absolute(command.report).parent_path();
  const bool is_other =
      fs::exists(command.report) && !fs::is_regular_file(fs::symlink_status(command.report));
  const bool beside =
      fs::weakly_canonical(folder) == fs::weakly_canonical(fs::absolute(command.out).parent_path());
  const std::string text = to_text(report_of(command, outcome));
  if (beside && !is_other)
    write_text(out.staging() / command.report.filename(), text);
  else
    write_whole(command.report, text);
}

/// Writes the levels. All have the materials of the first one.
void write_levels(const SimplifyCommand& command, const SimplifyOutcome& outcome, const fs::path& folder) {
  const InputLook& look = outcome.input.look;
  for (std::size_t i = 0; i < outcome.levels.size(); ++i) {
    const LevelExtras& extras = outcome.extras[i];
    const bool has_library = i > 0 && !look.materials.empty();
    sdm::write_mesh(folder / command.file(i).filename(), outcome.levels[i].mesh,
                    {.attributes = extras.attributes,
                     .materials = look.materials,
                     .textures = look.textures,
                     .face_materials = extras.face_materials,
                     .names = extras.names,
                     .library = has_library ? command.out.stem().string() + ".mtl" : std::string()});
  }
}

void run(const SimplifyCommand& command) {
  limit_threads(command.threads);
  std::vector<fs::path> planned;
  for (unsigned level = 0; level <= command.levels.lods; ++level)
    planned.push_back(command.file(level).filename());
  if (!command.report.empty()) planned.push_back(fs::absolute(command.report));
  OutputFolder out(fs::absolute(command.out).parent_path(),
                   {.planned = std::move(planned)});  // found before anything is computed
  ProgressLine progress(command.quiet);
  progress.step("import");
  SimplifyOutcome outcome;
  out.fill([&] {
    outcome = simplify_mesh(command, progress.callback());
    progress.step("output");
    sdm::Stopwatch watch;
    write_levels(command, outcome, out.staging());
    outcome.output_ms = watch.lap();
    if (!command.report.empty()) write_report(command, outcome, out);
  });
  print(
      command, [&] { return report_of(command, outcome); }, [&] { return summary(command, outcome); });
}

/// --triangles may also be a share of those of the mesh.
void add_triangles_option(CLI::App& app, SimplifyCommand& command) {
  static constexpr auto kTriangles = sdm::option_of(&sdm::LevelsOptions::triangles);
  sdm::OptionInfo info = sdm::info_of(kTriangles);
  info.text =
      "At most so many triangles, or P percent of those of the mesh; how far the result deviates is "
      "certified.";
  info.form = sdm::needed(info) + ", or a share such as 5%";
  info.value = "N|P%";
  add_declared_option(app, std::move(info), [&command](const std::string& text) {
    constexpr sdm::OptionRange kPercent{.least = 0, .most = 100, .above = true};
    if (!text.ends_with('%')) return sdm::read_value(kTriangles, text, command.levels);
    const std::string share = text.substr(0, text.size() - 1);
    return sdm::OptionForm<std::optional<double>>::read(share, kPercent, command.percent);
  });
}

void add_targets(CLI::App& app, SimplifyCommand& command) {
  add_declared_options(
      app, command.levels, {"triangles"},
      {{"lods",
        "So many further levels of detail, each with twice the deviation or half of the triangles of the "
        "one before, as NAME_lod1, NAME_lod2, ... beside the output."}});
  add_triangles_option(app, command);
}

std::string check_extension(const std::string& file) {
  try {
    (void)sdm::is_written_in_single_precision(file);
    return {};
  } catch (const sdm::Error& error) {
    return error.what();
  }
}

}  // namespace

void add_simplify_command(CLI::App& app) {
  CLI::App* simplify =
      app.add_subcommand("simplify", "Reduce a mesh to fewer triangles, with a certified deviation");
  simplify->footer(
      "The deviation is the symmetric Hausdorff distance of result and mesh, between certified bounds. "
      "With D, vertices are placed freely, unless the mesh has texture coordinates, or --keep-vertices is "
      "given, or faces of several materials or names meet; otherwise they are some of those of the mesh, and "
      "seams stay. "
      "Normals, colours, materials and names of faces are kept as far as the format has them; borders "
      "between materials stay. Where no mesh with fewer triangles keeps D, the result is the mesh itself, "
      "and a note says so.\n\n"
      "Example, a chain of three levels of detail:\n"
      "  sdm simplify scan.glb --max-deviation 0.1 --lods 2 -o low.glb");
  const auto command = std::make_shared<SimplifyCommand>();
  SimplifyCommand& c = *command;
  simplify->add_option("MESH", c.mesh, fmt::format("The mesh ({})", sdm::mesh_format_names()))->required();
  simplify->add_option("-o,--output", c.out, "The result, as PLY, OBJ, STL or GLB by its extension")
      ->required()
      ->check(CLI::Validator(check_extension, ""))
      ->type_name("FILE");
  add_targets(*simplify, c);
  add_weld_option(*simplify, c.weld, "the mesh");
  add_deflection_option(*simplify, c.tessellation);
  simplify->add_option("--report", c.report, "Write what --json prints to a file, too")
      ->check(non_empty())
      ->type_name("FILE");
  add_units_option(*simplify, c.units);
  add_run_options(*simplify, c, "JSON instead of a summary");
  simplify->callback([command] {
    if (!command->levels.max_deviation && !command->levels.triangles && !command->percent)
      throw CLI::ValidationError("sdm simplify", "--max-deviation or --triangles is required");
    for (unsigned level = 0; !command->report.empty() && level <= command->levels.lods; ++level)
      if (name_one_file(command->report, command->file(level)))
        throw CLI::ValidationError("--report", "it names a file of -o, " + command->report.string());
    check_units(command->units, command->mesh, "");
    run(*command);
  });
}
