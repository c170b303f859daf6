#include "map.h"

#include "core/parallel.h"
#include "output_folder.h"
#include "progress_line.h"
#include "report.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

namespace {

struct MapCommand {
  std::string o1, o2, transform_o1, transform_o2;
  std::filesystem::path out;
  sdm::AtlasOptions atlas;
  sdm::MapOptions map;
  sdm::PictureOptions picture;
  std::vector<double> range;
  unsigned threads = 0;
  bool both = false, json = false, quiet = false;
};

class Stopwatch {
 public:
  [[nodiscard]] double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Input load(std::string role, const std::string& file, const std::string& placement) {
  Input input{std::move(role), file, placement, sdm::read_mesh(file), {}};
  sdm::transform(input.mesh, sdm::parse_transform(placement));
  input.info = sdm::inspect(input.mesh);
  return input;
}

/// The distance at each vertex, signed as the map is; NaN beyond the maximum distance.
std::vector<float> vertex_distances(const sdm::Mesh& mesh, const sdm::Sites& sites,
                                    const sdm::DistanceMap& map, const sdm::MapOptions& options) {
  const auto closest = sdm::closest_points(sites, mesh.positions, options);
  std::vector<std::uint8_t> is_inside(closest.size(), 0);
  if (map.sign.method != sdm::SignMethod::none)
    is_inside = sdm::inside(sites, mesh.positions, closest, map.sign.method);
  std::vector<float> result;
  result.reserve(closest.size());
  for (std::size_t i = 0; i < closest.size(); ++i) {
    const double d = closest[i].type == sdm::SiteType::none ? std::nan("") : closest[i].distance;
    result.push_back(static_cast<float>(is_inside[i] ? -d : d));
  }
  return result;
}

Tolerance judge(double tolerance, const sdm::Surface& surface, const sdm::DistanceMap& map,
                const std::vector<float>& at_vertices, double error_bound) {
  double largest = map.beyond_max_distance > 0 ? std::numeric_limits<double>::infinity() : 0;
  for (const auto texel : surface.samples()) largest = std::fmax(largest, std::abs(map.distance[texel]));
  for (const auto& triangle : surface.mesh().triangles)
    for (const auto vertex : triangle) {
      const double d = std::abs(at_vertices[vertex]);
      largest = std::isnan(d) ? std::numeric_limits<double>::infinity() : std::max(largest, d);
    }
  Tolerance result{tolerance, sdm::area_fraction_beyond(surface, map, tolerance), largest <= tolerance, true};
  // Distances are 1-Lipschitz: within the bound of a sample they change by no more than the bound.
  if (result.within) result.certified = largest + error_bound <= tolerance;
  return result;
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out)
    throw sdm::Error("cannot write " + file.filename().string() + ": the disk may be full; free space on it");
}

struct Result {
  Outcome outcome;
  nlohmann::ordered_json report;
};

/// How far a value of the map can be off: the engine's 1e-6 of the diagonal of both meshes, which covers the
/// rounding to single precision too.
double engine_error(const Input& on, const Input& to) {
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double lo = std::min(on.info.bounds.lo[k], to.info.bounds.lo[k]);
    const double hi = std::max(on.info.bounds.hi[k], to.info.bounds.hi[k]);
    squared += (hi - lo) * (hi - lo);
  }
  return 1e-6 * std::sqrt(squared);
}

/// Computes the map on `on` of the distances to `to`, and writes all its files into `folder`.
Result measure(const MapCommand& command, const Input& on, const Input& to, double import_ms,
               const std::filesystem::path& folder, ProgressLine& progress) {
  const Stopwatch total;
  Result result;
  Outcome& outcome = result.outcome;
  outcome.time.import = import_ms;

  std::unique_ptr<sdm::Surface> surface;
  std::unique_ptr<sdm::Sites> sites;
  sdm::parallel_invoke(
      [&] {
        const Stopwatch watch;
        surface = std::make_unique<sdm::Surface>(on.mesh, command.atlas);
        outcome.time.atlas = watch.ms();
      },
      [&] {
        const Stopwatch watch;
        sites = std::make_unique<sdm::Sites>(to.mesh);
        outcome.time.sites = watch.ms();
      });

  const Stopwatch map_watch;
  const sdm::DistanceMap map = sdm::compute_map(*surface, *sites, command.map);
  const auto at_vertices = vertex_distances(on.mesh, *sites, map, command.map);
  outcome.time.map = map_watch.ms();
  outcome.sign = map.sign;
  outcome.beyond_max_distance = map.beyond_max_distance;

  progress.step("export");
  const Stopwatch export_watch;
  const std::vector<std::function<void()>> tasks{
      [&] { sdm::write_exr(folder / "map.exr", *surface, map); },
      [&] { sdm::write_glb(folder / "model.glb", *surface, map, at_vertices, command.picture); },
      [&] { sdm::write_distance_png(folder / "distance.png", *surface, map, command.picture); },
      [&] { sdm::write_direction_png(folder / "direction.png", *surface, map); },
      [&] { sdm::write_voronoi_png(folder / "voronoi.png", *surface, map); },
      [&] { outcome.distance = sdm::statistics(*surface, map); },
      [&] { outcome.error_bound = surface->sampling_bound(); },
  };
  sdm::parallel_for(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) tasks[i]();
  });
  if (command.picture.tolerance)
    outcome.tolerance = judge(*command.picture.tolerance, *surface, map, at_vertices,
                              outcome.error_bound + engine_error(on, to));
  outcome.time.output = export_watch.ms();
  outcome.time.total = import_ms + total.ms();

  const Input& o1 = on.role == "o1" ? on : to;
  const Input& o2 = on.role == "o1" ? to : on;
  nlohmann::ordered_json& report = result.report;
  report["version"] = sdm::kVersion;
  report["o1"] = to_json(o1);
  report["o2"] = to_json(o2);
  report["measured_on"] = on.role;
  report["units"] = command.picture.units;
  report["atlas"] = to_json(*surface);
  report["engine"] = command.map.engine == sdm::EngineKind::cpu ? "cpu" : "reference";
  report["max_distance"] = command.map.max_distance;  // null: no limit
  report.update(to_json(outcome));
  write_text(folder / "report.json", to_text(report));
  return result;
}

/// The exit code.
int run(MapCommand command) {
  const Stopwatch total;
  const sdm::ThreadLimit limit(command.threads);
  OutputFolder out(command.out);
  ProgressLine progress(command.quiet);
  command.atlas.progress = command.map.progress = progress.callback();
  if (!command.range.empty()) command.picture.range = {command.range[0], command.range[1]};

  progress.step("import");
  const Stopwatch import;
  Input o1, o2;
  sdm::parallel_invoke([&] { o1 = load("o1", command.o1, command.transform_o1); },
                       [&] { o2 = load("o2", command.o2, command.transform_o2); });
  const double import_ms = import.ms();

  std::vector<Result> results;
  try {
    results.push_back(measure(command, o1, o2, import_ms, out.staging(command.both ? "o1" : ""), progress));
    if (command.both) results.push_back(measure(command, o2, o1, import_ms, out.staging("o2"), progress));
    out.commit();
  } catch (const sdm::Error& error) {
    throw sdm::Error(out.publicly(error.what()));
  }

  if (command.json) {
    std::cout << to_text(command.both
                             ? nlohmann::ordered_json{{"o1", results[0].report}, {"o2", results[1].report}}
                             : results[0].report);
  } else if (!command.quiet) {
    std::cout << summary(o1, o2, results[0].outcome, command.picture.units);
    if (command.both) std::cout << summary(o2, o1, results[1].outcome, command.picture.units);
    const std::string folder = command.out.string() + (command.both ? "/{o1,o2}" : "");
    std::cout << "  time      " << std::round(total.ms()) / 1000 << " s\n  results   " << folder
              << "/: map.exr distance.png voronoi.png direction.png model.glb report.json\n";
  }
  const bool within = std::ranges::all_of(
      results, [](const Result& r) { return !r.outcome.tolerance || r.outcome.tolerance->within; });
  return within ? 0 : 3;
}

// Checks of the command line: each returns what is wrong, or nothing.
std::string check_transform(const std::string& text) try {
  (void)sdm::parse_transform(text);
  return {};
} catch (const sdm::Error& error) {
  return error.what();
}

CLI::Validator number(const std::string& description, bool (*accepts)(double)) {
  return CLI::Validator(
      [=](const std::string& text) {
        double value = 0;
        const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && accepts(value);
        return good ? std::string() : text + " is not " + description;
      },
      "");
}

CLI::Validator whole_number(int lowest, int highest) {
  return CLI::Validator(
      [=](const std::string& text) {
        int value = 0;
        const bool good = CLI::detail::lexical_cast(text, value) && lowest <= value && value <= highest;
        return good ? std::string()
                    : text + " is not a whole number from " + std::to_string(lowest) + " to " +
                          std::to_string(highest);
      },
      "");
}

template <class Enum>
void add_choice(CLI::App& app, const std::string& name, Enum& target, const std::string& description,
                const std::vector<std::pair<std::string, Enum>>& choices) {
  std::string names;
  for (const auto& choice : choices) names += (names.empty() ? "" : "|") + choice.first;
  const auto find = [choices](const std::string& text) -> std::optional<Enum> {
    for (const auto& [word, value] : choices)
      if (word == text) return value;
    return std::nullopt;
  };
  app.add_option_function<std::string>(
         name, [=, &target](const std::string& text) { target = *find(text); }, description)
      ->check(CLI::Validator(
          [=](const std::string& text) {
            return find(text) ? std::string() : text + " is not one of " + names;
          },
          ""))
      ->type_name(names)
      ->default_str(choices[0].first);
}

void add_options(CLI::App& app, MapCommand& c) {
  const auto positive = number("a positive number", [](double x) { return x > 0; });
  app.add_option("O1", c.o1, "The mesh that is measured on (OBJ, PLY, STL, OFF, glTF, 3DS)")->required();
  app.add_option("O2", c.o2, "The mesh that distances are measured to")->required();
  app.add_option("-o,--output", c.out, "The folder of the results, made if it is not there")
      ->required()
      ->check(CLI::Validator(
          [](const std::string& text) { return text.empty() ? "the name of the folder is empty" : ""; }, ""))
      ->type_name("DIR");
  app.add_flag("--both", c.both, "Measure O2 as well: results in DIR/o1 and DIR/o2");

  const std::string steps = ", placed by steps such as fit,rotate:0:90:0,scale:2,translate:0.8:0:0";
  app.add_option("--transform-o1", c.transform_o1, "O1" + steps)->check(check_transform)->type_name("STEPS");
  app.add_option("--transform-o2", c.transform_o2, "O2" + steps)->check(check_transform)->type_name("STEPS");

  app.add_option("--resolution", c.atlas.resolution, "Texels along each side of the map")
      ->check(whole_number(16, 32768))
      ->type_name("N")
      ->capture_default_str();
  add_choice<sdm::AtlasKind>(app, "--atlas", c.atlas.kind,
                             "How O1 is laid out in the map: few charts, a chart a triangle, or O1's own UVs",
                             {{"charts", sdm::AtlasKind::charts},
                              {"triangles", sdm::AtlasKind::triangles},
                              {"uv", sdm::AtlasKind::uv}});
  app.add_option("--max-stretch", c.atlas.max_stretch,
                 "Charts: the largest growth of a length from map to surface")
      ->check(number("a number above 1", [](double x) { return x > 1; }))
      ->type_name("S")
      ->capture_default_str();

  app.add_option("--max-distance", c.map.max_distance, "Texels farther than this hold no value")
      ->check(positive)
      ->type_name("D");
  add_choice<sdm::SignMethod>(app, "--sign", c.map.sign,
                              "How the inside of O2 (negative) is told; auto: only where O2 is closed",
                              {{"auto", sdm::SignMethod::automatic},
                               {"none", sdm::SignMethod::none},
                               {"pseudonormal", sdm::SignMethod::pseudonormal},
                               {"winding", sdm::SignMethod::winding}});
  add_choice<sdm::EngineKind>(app, "--engine", c.map.engine,
                              "The fast engine, or the plain one to compare it with",
                              {{"cpu", sdm::EngineKind::cpu}, {"reference", sdm::EngineKind::reference}});
  app.add_option("--tolerance", c.picture.tolerance,
                 "Colour bands and exit code 3 where a distance is above D, inside or outside")
      ->check(number("a number, 0 or more", [](double x) { return x >= 0; }))
      ->type_name("D");

  add_choice<sdm::Colormap>(app, "--colormap", c.picture.colormap,
                            "Colours; auto: diverging where distances have both signs, else viridis",
                            {{"auto", sdm::Colormap::automatic},
                             {"viridis", sdm::Colormap::viridis},
                             {"diverging", sdm::Colormap::diverging},
                             {"paper2006", sdm::Colormap::paper2006}});
  app.add_option("--range", c.range, "The distances at the ends of the colours")
      ->expected(2)
      ->check(number("a number", [](double) { return true; }))
      ->type_name("LO HI");
  app.add_option("--units", c.picture.units,
                 "Of the meshes, for the legend; m, cm, mm, um, in, ft also scale model.glb to metres")
      ->type_name("NAME");

  app.add_option("--threads", c.threads, "Threads to use, 0 for all cores")
      ->check(whole_number(0, 1024))
      ->type_name("N")
      ->capture_default_str();
  app.add_flag("--json", c.json, "Print the report (report.json) instead of a summary");
  app.add_flag("--quiet", c.quiet, "Print nothing but errors, and what --json asks for");
}

}  // namespace

void add_map_command(CLI::App& app) {
  CLI::App* map = app.add_subcommand("map", "Measure the distance from everywhere on mesh O1 to mesh O2");
  map->footer(
      "Writes map.exr (all values), distance.png, voronoi.png, direction.png, model.glb (O1 in colours) and "
      "report.json.\n"
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 tolerance exceeded.\n\n"
      "Example, two meshes side by side:\n"
      "  sdm map bunny.obj armadillo.off -o out --transform-o1 fit --transform-o2 fit,translate:0.8:0:0");
  const auto command = std::make_shared<MapCommand>();
  add_options(*map, *command);
  map->callback([command] {
    const auto& range = command->range;
    if (!range.empty() && !(range[0] < range[1]))
      throw CLI::ValidationError("--range", "LO must be below HI");
    if (command->picture.tolerance && *command->picture.tolerance > command->map.max_distance)
      throw CLI::ValidationError("--tolerance",
                                 "must not be above --max-distance, which hides what exceeds it");
    if (const int code = run(*command); code != 0) throw CLI::RuntimeError(code);
  });
}
