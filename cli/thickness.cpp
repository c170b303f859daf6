#include "thickness.h"

#include <fmt/format.h>
#include <sdm/map_files.h>
#include <sdm/measure.h>
#include <sdm/mesh_files.h>

#include "cad_options.h"
#include "common_options.h"
#include "declared_options.h"
#include "doubts.h"
#include "exit_codes.h"
#include "format.h"
#include "notes.h"
#include "option_checks.h"
#include "output_folder.h"
#include "part_map.h"
#include "print.h"
#include "progress_line.h"
#include "src/core/stopwatch.h"
#include "src/io/json/report_json.h"
#include "weld.h"

#include <limits>
#include <memory>

namespace {

using Json = nlohmann::ordered_json;
using sdm::ThicknessMethod;

struct ThicknessCommand : PartMapCommand {
  sdm::ThicknessOptions thickness;  ///< by the method that is drawn and judged
  std::optional<double> least{}, most{};
  double uncertainty = 0;
};

struct ThicknessResult {
  sdm::Summary summary;
  Json report;
};

ThicknessMethod other_method(const ThicknessCommand& command) {
  return command.thickness.method == ThicknessMethod::ball ? ThicknessMethod::ray : ThicknessMethod::ball;
}

std::string text_of_method(const ThicknessCommand& command) {
  if (command.thickness.method == ThicknessMethod::ray)
    return "the length of the ray into the part along the normal, until it leaves the part";
  return fmt::format(
      "the diameter of the largest ball in the part that touches there, stopped only by faces that turn by "
      "more than {}°",
      number(command.thickness.angle));
}

/// The limits, infinite where none was given.
std::optional<sdm::Tolerance> limits_of(const ThicknessCommand& command) {
  if (!command.least && !command.most) return std::nullopt;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  return sdm::Tolerance(command.least.value_or(-kNone), command.most.value_or(kNone));
}

std::string limits_in_words(const ThicknessCommand& command) {
  return sdm::limits_text(*limits_of(command), command.picture.units, false);
}

/// The verdict as a clause: that of sdm::verdict_text(), but of the limits that were given.
std::string verdict_in_words(const ThicknessCommand& command, const sdm::Summary& summary) {
  const std::string by = sdm::uncertainty_text(command.uncertainty, summary.units);
  switch (summary.tolerance->verdict) {
    case sdm::Verdict::pass:
      return fmt::format("every measured point has {}{}; between them, an estimate", limits_in_words(command),
                         by);
    case sdm::Verdict::fail:
      return summary.tolerance->reason == sdm::VerdictReason::exceeded
                 ? fmt::format("a measured point does not have {}{}", limits_in_words(command), by)
                 : sdm::verdict_text(summary);
    default:
      return fmt::format("a measured point is as close to the limit, {}, as a thickness is accurate, {}{}",
                         limits_in_words(command),
                         number(summary.evidence.accuracy + summary.evidence.guard, 2),
                         unit_suffix(summary.units));
  }
}

/// Whether the thickest places matter, and not the thinnest ones.
bool only_most(const ThicknessCommand& command) {
  return command.most && !command.least;
}

Json thickness_json(const ThicknessCommand& command, const sdm::Surface& surface, const sdm::DistanceMap& map,
                    const sdm::Summary& other) {
  const auto given = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  const std::string name = name_of(other_method(command));
  Json json{{"method", name_of(command.thickness.method)},
            {"text", text_of_method(command)},
            {"angle", command.thickness.angle},
            {"min", given(command.least)},
            {"max", given(command.most)}};
  const auto listed = [&](const std::vector<std::uint32_t>& texels) {
    Json list = Json::array();
    for (const std::uint32_t texel : texels)
      list.push_back({{"thickness", map.distance[texel]}, {"point", surface.texel_point(texel)}});
    return list;
  };
  if (!only_most(command)) json["thinnest"] = listed(sdm::thinnest_texels(surface, map));
  if (command.most) json["thickest"] = listed(sdm::thickest_texels(surface, map));
  json["other"] = {{"method", name},
                   {"file", command.files.exr ? Json(name + ".exr") : Json()},
                   {"distance", sdm::to_json(other.distance)}};
  return json;
}

/// Writes all files into `folder`.
ThicknessResult measure(const ThicknessCommand& command, const LoadedPart& loaded,
                        const std::filesystem::path& folder, ProgressLine& progress) {
  PartMap part(loaded.input, loaded.import_ms, command.atlas);
  progress.step("sites");
  const sdm::Sites sites(part.input.mesh);
  part.times.sites = part.watch.lap();
  part.map = sdm::compute_map(part.surface, sites, command.thickness);
  sdm::ThicknessOptions by_other = command.thickness;
  by_other.method = other_method(command);
  const sdm::DistanceMap other = sdm::compute_map(part.surface, sites, by_other);
  part.at_vertices = sdm::distances_at_vertices(part.input.mesh, sites, command.thickness);
  part.times.map = part.watch.lap();

  progress.step("export");
  const sdm::Summary of_other =
      sdm::summarize_thickness(part.surface, other, {.accuracy = command.picture.accuracy});
  ThicknessResult result{sdm::summarize_thickness(part.surface, part.map,
                                                  {.units = command.picture.units,
                                                   .accuracy = command.picture.accuracy,
                                                   .guard = 2 * part.input.deviation,  // of both ends
                                                   .uncertainty = command.uncertainty,
                                                   .tolerance = command.picture.tolerance,
                                                   .colormap = command.picture.colormap,
                                                   .range = command.picture.range,
                                                   .names = part.input.names}),
                         {}};
  const auto write = [&](sdm::ExrOptions exr) {
    if (!command.files.exr) return;
    exr.attributes = exr_attributes(part.input, part.input, other, command.picture.units);
    sdm::write_exr(folder / fmt::format("{}.exr", name_of(other_method(command))), part.surface, other, exr);
  };
  const auto extend = [&](Json& report) {
    report["thickness"] = thickness_json(command, part.surface, part.map, of_other);
    if (result.summary.tolerance) report["tolerance"]["text"] = verdict_in_words(command, result.summary);
  };
  result.report = write_part_map(
      command, part, sites, result.summary, folder,
      {.write = write,
       .extend = extend,
       .page = {.up = command.picture.up,
                .places = only_most(command) ? sdm::ListedPlaces::largest : sdm::ListedPlaces::least}});
  return result;
}

std::string tolerance_text(const ThicknessCommand& command, const sdm::Summary& summary, double size) {
  if (!summary.tolerance) return {};
  const sdm::CertifiedVerdict& verdict = *summary.tolerance;
  std::string text = fmt::format("  limits      {}: ", sdm::name_of(verdict.verdict));
  if (verdict.verdict == sdm::Verdict::fail && summary.extremes) {
    const sdm::Extreme most = decisive_extreme(summary).value_or(sdm::Extreme{});
    text += fmt::format("{} % of the area does not have {}; {}{} at {}",
                        number(100 * verdict.exceeded_area_fraction), limits_in_words(command),
                        number(most.distance), unit_suffix(summary.units), place(most.point, size));
  } else {
    text += verdict_in_words(command, summary);
  }
  return text + "\n";
}

std::string thickness_summary(const ThicknessCommand& command, const ThicknessResult& result, double size) {
  const sdm::Summary& s = result.summary;
  const std::string unit = unit_suffix(s.units), name = name_of(command.thickness.method);
  std::string text = heading(fmt::format("{}: wall thickness", command.part.file), judged(s, {}));
  if (!s.extremes) {
    text += "  thickness   no texel has a value\n";
  } else {
    text += fmt::format("  {:<12}min {}   mean {}   max {}{} (exact at the texels)\n", name,
                        number(s.distance.min), number(s.distance.mean), number(s.distance.max), unit);
    text += fmt::format("              5 % of the area has up to {}, 50 % up to {}{}\n",
                        number(s.distance.p05), number(s.distance.p50), unit);
    text += only_most(command)
                ? fmt::format("              most at {}\n", place(s.extremes->max.point, size))
                : fmt::format("              least at {}\n", place(s.extremes->min.point, size));
    const Json& other = result.report["thickness"]["other"];
    const auto of_other = [&](const char* key) { return number(other["distance"][key].get<double>()); };
    text += fmt::format("  {:<12}min {}   mean {}   max {}{}\n", other["method"].get<std::string>(),
                        of_other("min"), of_other("mean"), of_other("max"), unit);
  }
  if (s.beyond_max_distance > 0)
    text += fmt::format("              {} texels have no value\n", s.beyond_max_distance);
  return text + tolerance_text(command, s, size) + note_lines(s.notes, 14);
}

int run(ThicknessCommand command) {
  sdm::Stopwatch total;
  limit_threads(command.threads);
  OutputFolder out(command.out, {.command = "map", .planned = planned_files(command.files)});
  ProgressLine progress(command.quiet);
  command.atlas.progress = command.thickness.progress = progress.callback();

  progress.step("import");
  const LoadedPart part = load_part(command.part, command.files.any_vertices());
  const Input& input = part.input;
  check_closed(input, "wall thickness");
  const double size = size_of(sdm::bounds(input.mesh));
  command.picture.accuracy = sdm::thickness_accuracy(input.mesh);
  command.picture.tolerance = limits_of(command);
  ThicknessResult result;
  out.fill([&] { result = measure(command, part, out.staging(), progress); });

  print(
      command, [&] { return result.report; },
      [&] {
        std::string files = listed(command.files);
        if (command.files.exr) files = fmt::format("{}.exr {}", name_of(other_method(command)), files);
        return thickness_summary(command, result, size) +
               result_lines(14, total.lap(), command.out.string(), files);
      });
  return result.summary.tolerance ? exit_code(result.summary.tolerance->verdict) : kSuccess;
}

void add_limits(CLI::App& app, ThicknessCommand& c) {
  add_declared_options(app, c.thickness);
  app.add_option("--min", c.least, "Check that no texel is thinner than this")
      ->check(positive_number())
      ->type_name("T");
  app.add_option("--max", c.most, "Check that no texel is thicker than this")
      ->check(positive_number())
      ->type_name("T");
  add_uncertainty_option(app, c.uncertainty);
}

}  // namespace

void add_thickness_command(CLI::App& app) {
  CLI::App* thickness = app.add_subcommand("thickness", "Compute the wall thickness of a closed mesh");
  thickness->footer(
      "Values are exact at the texels, and an estimate for the surface between them.\n"
      "Writes views.png (the mesh from six sides), map.exr (all values), ray.exr (the other method), "
      "atlas_distance.png, atlas_voronoi.png, atlas_direction.png, model.glb, report.html and "
      "report.json.\n" +
      exit_codes() +
      "\n\n"
      "Example, walls of a casting that must have at least 3 mm:\n"
      "  sdm thickness casting.stl -o out --min 3 --units mm");
  const auto command = std::make_shared<ThicknessCommand>();
  ThicknessCommand& c = *command;
  thickness
      ->add_option("PART", c.part.file,
                   fmt::format("The mesh ({}), which must be closed", sdm::mesh_format_names()))
      ->required();
  add_output_option(*thickness, c.out);
  add_transform_option(*thickness, "--transform", "The part", c.part.transform);
  add_weld_option(*thickness, c.part.weld, "the part");
  add_deflection_option(*thickness, c.part.tessellation);
  add_limits(*thickness, c);
  add_part_map_options(*thickness, c);
  thickness->callback([command] {
    check_part_map(*command);
    if (command->least && command->most && *command->least > *command->most)
      throw CLI::ValidationError("--min", "must not exceed --max");
    check_uncertainty(command->uncertainty, command->least || command->most);
    if (const int code = run(*command); code != 0) throw CLI::RuntimeError(code);
  });
}
