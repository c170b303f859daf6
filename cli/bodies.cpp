#include "bodies.h"

#include <fmt/format.h>
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "bodies_report.h"
#include "common_options.h"
#include "format.h"
#include "map_files.h"
#include "option_checks.h"
#include "output_folder.h"
#include "progress_line.h"
#include "report.h"
#include "stopwatch.h"

namespace {

struct BodiesCommand {
  std::vector<std::string> files;
  std::string units;
  std::filesystem::path out;
  sdm::MultiBodyOptions options;
  MapFiles map_files;
  unsigned threads = 0;
  bool json = false, quiet = false;
};

std::vector<std::filesystem::path> earlier_files(const BodiesCommand& command) {
  std::vector<std::filesystem::path> files{"report.json"};
  for (std::size_t body = 0; body < command.files.size(); ++body) {
    const std::filesystem::path folder = fmt::to_string(body);
    for (const std::string& file : names({})) files.push_back(folder / file);
    files.push_back(folder / "body.npy");
  }
  return files;
}

/// Writes the map of each body to a folder named after its number.
void write_maps(const BodiesCommand& command, const sdm::MultiBodyQuery& bodies, OutputFolder& out) {
  sdm::NearestMap nearest;
  for (std::size_t body = 0; body < bodies.size(); ++body) {
    bodies.nearest_map(body, nearest);
    const std::filesystem::path folder = out.staging(fmt::to_string(body));
    std::vector<float> at_vertices;
    if (command.map_files.glb)
      at_vertices = sdm::nearest_distances_at_vertices(bodies, body, command.options.max_distance);
    write_map_files(folder, command.map_files, bodies.surface(body), nearest.map, at_vertices,
                    {.units = command.units});
    sdm::write_npy(folder / "body.npy", nearest.map.resolution, nearest.body);
  }
}

nlohmann::ordered_json report_of(const BodiesCommand& command, const std::vector<Input>& inputs,
                                 sdm::MultiBodyQuery& bodies) {
  nlohmann::ordered_json report;
  report["version"] = sdm::kVersion;
  report["bodies"] = nlohmann::ordered_json::array();
  for (const Input& input : inputs) report["bodies"].push_back(to_json(input));
  report["units"] = command.units;
  report["resolution"] = command.options.atlas.resolution;
  report["max_distance"] = command.options.max_distance;  // null: no limit
  report["pairs"] = nlohmann::ordered_json::array();
  for (const sdm::PairProximity& pair : bodies.pairs()) report["pairs"].push_back(to_json(pair));
  report["candidate_pairs"] = bodies.candidate_pairs();
  return report;
}

std::string bodies_summary(const BodiesCommand& command, sdm::MultiBodyQuery& bodies) {
  std::string text;
  for (std::size_t body = 0; body < bodies.size(); ++body)
    text += fmt::format("  {}  {}\n", body, command.files[body]);
  text += "\n" + table(bodies.pairs());
  if (!command.units.empty()) text += fmt::format("\n  lengths in {}\n", command.units);
  if (!command.out.empty())
    text += fmt::format("\n  results   {}/: report.json and, of each body, N/: {}body.npy\n",
                        command.out.string(), listed(command.map_files));
  return text;
}

void run(BodiesCommand command) {
  limit_threads(command.threads);
  std::optional<OutputFolder> out;
  if (!command.out.empty()) out.emplace(command.out, earlier_files(command));
  ProgressLine progress(command.quiet);
  command.options.atlas.progress = progress.callback();

  progress.step("import");
  Stopwatch watch;
  std::vector<Input> inputs;
  std::vector<sdm::Mesh> meshes;
  for (const std::string& file : command.files) {
    inspect(inputs.emplace_back(load_input(fmt::format("body {}", inputs.size()), file, "")));
    meshes.push_back(inputs.back().mesh);
  }
  const double import_ms = watch.lap();
  sdm::MultiBodyQuery bodies(std::move(meshes), command.options);
  const double build_ms = watch.lap();
  progress.step("queries");
  nlohmann::ordered_json report = report_of(command, inputs, bodies);
  report["time_ms"] = {{"import", import_ms}, {"build", build_ms}, {"query", watch.lap()}};

  if (out)
    out->fill([&] {
      progress.step("maps");
      write_maps(command, bodies, *out);
      report["time_ms"]["maps"] = watch.lap();
      write_text(out->staging() / "report.json", to_text(report));
    });
  if (command.json) {
    std::cout << to_text(report);
  } else if (!command.quiet) {
    std::cout << bodies_summary(command, bodies);
  }
}

void add_options(CLI::App& app, BodiesCommand& c) {
  app.add_option("FILE", c.files,
                 fmt::format("One mesh per body ({}), at least two", sdm::mesh_format_names()))
      ->required()
      ->expected(2, CLI::detail::expected_max_vector_size);
  add_output_option(app, c.out)
      ->required(false)
      ->description("Output folder for the map of each body to all others, created if missing");
  app.add_option("--max-distance", c.options.max_distance, "Omit pairs, and texels, farther apart than D")
      ->check(number("a positive number", [](double x) { return x > 0; }))
      ->type_name("D");
  add_units_option(app, c.units);
  add_write_option(app, c.map_files);
  add_resolution_option(app, c.options.atlas, "all bodies' maps");
  add_run_options(app, c.threads, c.json, c.quiet, "JSON instead of a table");
}

}  // namespace

void add_bodies_command(CLI::App& app) {
  CLI::App* bodies = app.add_subcommand(
      "bodies", "Compute separation, collision and penetration depth of all near pairs of many meshes");
  bodies->footer(
      "Bodies are numbered from 0 in the given order. With -o, each has a folder named by its number, with "
      "its\n"
      "map to the nearest of the other bodies, in the files of `sdm map`, and body.npy, the index of that "
      "body.\n\n"
      "Example, all pairs closer than 5:\n"
      "  sdm bodies part1.stl part2.stl housing.stl --max-distance 5");
  const auto command = std::make_shared<BodiesCommand>();
  add_options(*bodies, *command);
  bodies->callback([command] { run(*command); });
}
