#include "thickness.h"

#include <fmt/format.h>
#include <sdm/io.h>
#include <sdm/thickness.h>

#include "cad_options.h"
#include "common_options.h"
#include "exit_codes.h"
#include "format.h"
#include "map_files.h"
#include "notes.h"
#include "option_checks.h"
#include "output_folder.h"
#include "part_file.h"
#include "print.h"
#include "progress_line.h"
#include "report.h"
#include "stopwatch.h"
#include "unit_options.h"
#include "weld.h"

#include <limits>
#include <map>
#include <memory>

namespace {

using Json = nlohmann::ordered_json;
using sdm::ThicknessMethod;

struct ThicknessCommand : RunOptions {
  PartFile part;
  std::filesystem::path out;
  sdm::AtlasOptions atlas;
  sdm::ThicknessOptions thickness;
  ThicknessMethod method = ThicknessMethod::ball;
  std::optional<double> least{}, most{};
  sdm::PictureOptions picture;
  MapFiles files;
};

struct ThicknessResult {
  sdm::Summary summary;
  Json report;
};

const std::map<std::string, ThicknessMethod> kMethods{{"ball", ThicknessMethod::ball},
                                                      {"ray", ThicknessMethod::ray}};

std::string name_of_method(ThicknessMethod method) {
  return method == ThicknessMethod::ball ? "ball" : "ray";
}

ThicknessMethod other_method(ThicknessMethod method) {
  return method == ThicknessMethod::ball ? ThicknessMethod::ray : ThicknessMethod::ball;
}

std::string text_of_method(const ThicknessCommand& command) {
  if (command.method == ThicknessMethod::ray)
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
  switch (summary.tolerance->verdict) {
    case sdm::Verdict::pass:
      return fmt::format("every measured point has {}; between them, an estimate", limits_in_words(command));
    case sdm::Verdict::fail:
      return summary.tolerance->reason == sdm::VerdictReason::exceeded
                 ? fmt::format("a measured point does not have {}", limits_in_words(command))
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
  const std::string name = name_of_method(other_method(command.method));
  Json json{{"method", name_of_method(command.method)},
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
                   {"distance", Json::parse(sdm::summary_json(other))["distance"]}};
  return json;
}

/// Writes all files but the page into `folder`.
void write_files(const ThicknessCommand& command, const Input& input, const sdm::Surface& surface,
                 const sdm::ThicknessMaps& maps, std::span<const float> at_vertices,
                 const sdm::PictureOptions& fixed, const std::filesystem::path& folder) {
  const bool ball = command.method == ThicknessMethod::ball;
  const sdm::DistanceMap &map = ball ? maps.ball : maps.ray, &other = ball ? maps.ray : maps.ball;
  sdm::run_concurrently(
      {[&] {
         write_map_files(folder, command.files, surface, map, at_vertices, nullptr, command.picture, fixed);
       },
       [&] {
         if (command.files.exr)
           sdm::write_exr(folder / (name_of_method(other_method(command.method)) + ".exr"), surface, other);
       },
       [&] {
         if (input.vertices) write_vertex_files(folder, command.files, *input.vertices, at_vertices);
       }});
}

/// Writes all files into `folder`.
ThicknessResult measure(ThicknessCommand& command, const Input& input, double import_ms,
                        const std::filesystem::path& folder, ProgressLine& progress) {
  Stopwatch total, watch;
  const sdm::Surface surface(input.mesh, command.atlas);
  const double atlas_ms = watch.lap();
  progress.step("sites");
  const sdm::Sites sites(input.mesh);
  const double sites_ms = watch.lap();
  const sdm::ThicknessMaps maps = sdm::thickness_maps(surface, sites, command.thickness);
  const auto at_vertices = sdm::thickness_at_vertices(sites, command.method, command.thickness);
  const double map_ms = watch.lap();

  progress.step("export");
  const bool ball = command.method == ThicknessMethod::ball;
  const sdm::DistanceMap &map = ball ? maps.ball : maps.ray, &other = ball ? maps.ray : maps.ball;
  const sdm::DistanceStatistics distance = sdm::statistics(surface, map);
  sdm::SummaryOptions options{.units = command.picture.units,
                              .accuracy = command.picture.accuracy,
                              .guard = 2 * input.deviation,  // of both ends
                              .tolerance = command.picture.tolerance,
                              .colormap = command.picture.colormap,
                              .range = command.picture.range,
                              .names = input.names};
  const sdm::Summary of_other =
      sdm::summarize_thickness(surface, other, {.accuracy = command.picture.accuracy});
  options.distance = &distance;
  ThicknessResult result{sdm::summarize_thickness(surface, map, options), {}};
  result.summary.notes.insert(result.summary.notes.begin(), input.notes.begin(), input.notes.end());
  if (auto note = note_on_unit(command.picture.units)) result.summary.notes.push_back(std::move(*note));
  sdm::PictureOptions picture = sdm::fixed_colors(command.picture, *result.summary.colors);
  if (const auto verdict = judged(result.summary, {})) picture.verdict.emplace(*verdict);
  write_files(command, input, surface, maps, at_vertices, picture, folder);
  const double export_ms = watch.lap();
  const sdm::ReportTimes times{.import = import_ms,
                               .atlas = atlas_ms,
                               .sites = sites_ms,
                               .map = map_ms,
                               .output = export_ms,
                               .total = import_ms + total.lap()};
  result.report = Json::parse(
      sdm::report_json({.on = reported(input), .engine = "cpu", .time_ms = times}, surface, result.summary));
  result.report["thickness"] = thickness_json(command, surface, map, of_other);
  if (result.summary.tolerance) {
    Json& tolerance = result.report["tolerance"];
    tolerance["text"] = verdict_in_words(command, result.summary);
  }
  const std::string text = to_text(result.report);
  if (command.files.html)
    sdm::write_html(
        folder / "report.html", surface, map, at_vertices, text,
        {.up = command.picture.up, .thinnest = !only_most(command), .thickest = only_most(command)});
  write_text(folder / "report.json", text);
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
  const std::string unit = unit_suffix(s.units), name = name_of_method(command.method);
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
  Stopwatch total;
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
  out.fill([&] { result = measure(command, input, part.import_ms, out.staging(), progress); });

  print(
      command, [&] { return result.report; },
      [&] {
        std::string files = listed(command.files);
        if (command.files.exr) files = name_of_method(other_method(command.method)) + ".exr " + files;
        return thickness_summary(command, result, size) +
               result_lines(14, total.lap(), command.out.string(), files);
      });
  return result.summary.tolerance ? exit_code(result.summary.tolerance->verdict) : kSuccess;
}

void add_limits(CLI::App& app, ThicknessCommand& c) {
  app.add_option(
         "--method", c.method,
         "The thickness that is drawn and judged: ball, the diameter of the largest ball that touches "
         "at a texel, or ray, the length of the ray from it along the inward normal. The other one is "
         "in the report and in a file of its own")
      ->transform(CLI::CheckedTransformer(kMethods).description(""))
      ->type_name("ball|ray")
      ->default_str("ball");
  app.add_option("--angle", c.thickness.angle,
                 "The ball is stopped only by faces whose normal turns by more than this from that of the "
                 "texel's face, in degrees")
      ->check(number("between 0 and 180", [](double x) { return x > 0 && x < 180; }))
      ->type_name("A")
      ->capture_default_str();
  app.add_option("--min", c.least, "Check that no texel is thinner than this")
      ->check(positive_number())
      ->type_name("T");
  app.add_option("--max", c.most, "Check that no texel is thicker than this")
      ->check(positive_number())
      ->type_name("T");
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
  add_resolution_option(*thickness, c.atlas);
  add_layout_options(*thickness, c.atlas, "the part");
  add_write_option(*thickness, c.files, true);
  add_picture_options(*thickness, c.picture);
  add_run_options(*thickness, c, "the report (report.json) instead of a summary");
  thickness->callback([command] {
    check_layout(command->atlas);
    check_units(command->picture.units, command->part.file, command->part.transform);
    if (command->least && command->most && *command->least > *command->most)
      throw CLI::ValidationError("--min", "must not exceed --max");
    if (const int code = run(*command); code != 0) throw CLI::RuntimeError(code);
  });
}
