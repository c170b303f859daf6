#include "bodies.h"

#include <fmt/format.h>
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>

#include "bodies_report.h"
#include "common_options.h"
#include "declared_options.h"
#include "map_files.h"
#include "notes.h"
#include "option_checks.h"
#include "output_folder.h"
#include "poses_file.h"
#include "print.h"
#include "progress_line.h"
#include "report.h"
#include "src/core/stopwatch.h"
#include "src/io/json/report_json.h"
#include "unit_options.h"

namespace {

struct BodiesCommand : RunOptions {
  std::vector<std::string> files;
  std::string units;
  std::filesystem::path out, poses;
  sdm::ProximityOptions options;
  double max_distance = std::numeric_limits<double>::infinity();
  sdm::AtlasOptions atlas{.resolution = 128};
  MapFiles map_files{.views = false};
};

/// The files that are written whatever the meshes are.
std::vector<std::filesystem::path> planned_files(const BodiesCommand& command) {
  std::vector<std::filesystem::path> files{"report.json"};
  for (std::size_t body = 0; body < command.files.size(); ++body) {
    const std::filesystem::path folder = fmt::to_string(body);
    for (const std::string& file : names(command.map_files)) files.push_back(folder / file);
    files.push_back(folder / "body.npy");
  }
  return files;
}

/// Writes the map of each body to a folder named after its number.
void write_maps(const BodiesCommand& command, const sdm::MultiBodyQuery& bodies, OutputFolder& out) {
  sdm::NearestMap nearest;
  for (std::size_t body = 0; body < bodies.size(); ++body) {
    bodies.nearest_map(body, command.max_distance, nearest);
    const std::filesystem::path folder = out.staging(fmt::to_string(body));
    std::vector<float> at_vertices;
    if (command.map_files.glb || command.map_files.views)
      at_vertices = sdm::nearest_distances_at_vertices(bodies, body, command.max_distance);
    const sdm::PictureOptions picture{.units = command.units};
    write_map_files(folder, command.map_files, bodies.surface(body), nearest.map, at_vertices, nullptr,
                    picture, sdm::fixed_colors(picture, sdm::statistics(bodies.surface(body), nearest.map)));
    sdm::write_npy(folder / "body.npy", nearest.map.resolution,
                   std::span(nearest.body).first(nearest.map.texels()));
  }
}

nlohmann::ordered_json report_of(const BodiesCommand& command, const std::vector<Input>& inputs,
                                 sdm::MultiBodyQuery& bodies, std::span<const PairResults> pairs) {
  nlohmann::ordered_json report;
  report["version"] = sdm::kVersion;
  report["bodies"] = nlohmann::ordered_json::array();
  for (const Input& input : inputs) report["bodies"].push_back(to_json(input));
  report["units"] = command.units;
  if (!command.out.empty()) report["resolution"] = command.atlas.resolution;
  report["max_distance"] = command.max_distance;  // null: no limit
  report["settings"] = sdm::settings_json(command.options);
  report["pairs"] = nlohmann::ordered_json::array();
  for (const PairResults& pair : pairs)
    report["pairs"].push_back(sdm::to_json(pair.separation, pair.penetration_depth));
  report["candidate_pairs"] = bodies.candidate_pairs();
  report["contacts"] = to_json(bodies.contacts());
  return report;
}

std::string bodies_summary(const BodiesCommand& command, sdm::MultiBodyQuery& bodies,
                           std::span<const PairResults> pairs, const Notes& notes) {
  std::string text;
  for (std::size_t body = 0; body < bodies.size(); ++body)
    text += fmt::format("  {}  {}\n", body, command.files[body]);
  text += "\n" + table(pairs);
  std::size_t contacts = 0;
  for (const sdm::PairContacts& pair : bodies.contacts()) contacts += pair.contacts.size();
  text += fmt::format("\n  contacts  {}\n", contacts);
  if (!notes.empty()) text += "\n" + note_lines(notes, 12);
  if (!command.units.empty()) text += fmt::format("\n  lengths in {}\n", command.units);
  if (!command.out.empty())
    text += fmt::format("\n  results   {}/: report.json and, of each body, N/: {}body.npy\n",
                        command.out.string(), listed(command.map_files));
  return text;
}

/// A file that several bodies name is read once.
Input load_body(const std::vector<Input>& earlier, const std::string& file) {
  const auto same = std::ranges::find(earlier, file, &Input::file);
  Input input;
  if (same != earlier.end())
    input = *same;
  else
    inspect(input = load_input(fmt::format("body {}", earlier.size()), file, ""));
  input.role = fmt::format("body {}", earlier.size());
  return input;
}

/// Bodies of the same file share a shape. `atlas`: none if null.
std::vector<sdm::Shape> shapes_of(const std::vector<Input>& inputs, const sdm::AtlasOptions* atlas) {
  std::vector<sdm::Shape> shapes;
  for (std::size_t body = 0; body < inputs.size(); ++body) try {
      const auto same = std::ranges::find(inputs, inputs[body].file, &Input::file) - inputs.begin();
      if (static_cast<std::size_t>(same) < body)
        shapes.push_back(shapes[static_cast<std::size_t>(same)]);
      else
        shapes.push_back(atlas ? sdm::Shape(inputs[body].mesh, *atlas) : sdm::Shape(inputs[body].mesh));
    } catch (const sdm::Cancelled&) {
      throw;
    } catch (const sdm::Error& error) {
      throw sdm::Error(fmt::format("body {}: {}", body, error.what()), error.remedy());
    }
  return shapes;
}

void set_poses(sdm::MultiBodyQuery& bodies, const std::vector<sdm::Transform>& poses,
               const std::filesystem::path& file) try {
  bodies.set_poses(poses);
} catch (const sdm::Error& error) {
  throw sdm::Error(fmt::format("{}: {}", file.string(), error.what()));
}

void run(BodiesCommand command) {
  limit_threads(command.threads);
  std::optional<OutputFolder> out;
  if (!command.out.empty())
    out.emplace(command.out, OutputFiles{.command = "bodies", .planned = planned_files(command)});
  ProgressLine progress(command.quiet);
  command.atlas.progress = progress.callback();

  progress.step("import");
  sdm::Stopwatch watch;
  std::vector<sdm::Transform> poses;
  if (!command.poses.empty()) poses = read_poses(command.poses, command.files.size());
  std::vector<Input> inputs;
  for (const std::string& file : command.files) inputs.push_back(load_body(inputs, file));
  const double import_ms = watch.lap();
  sdm::MultiBodyQuery bodies(shapes_of(inputs, out ? &command.atlas : nullptr), command.options);
  if (!poses.empty()) set_poses(bodies, poses, command.poses);
  const double build_ms = watch.lap();
  progress.step("queries");
  std::vector<sdm::Transform> set;
  for (std::size_t body = 0; body < bodies.size(); ++body) set.push_back(bodies.pose(body));
  Notes notes = notes_on(inputs, set);
  if (auto note = note_on_unit(command.units)) notes.push_back(std::move(*note));
  const std::vector<PairResults> pairs = results_of(bodies, command.max_distance);
  nlohmann::ordered_json report = report_of(command, inputs, bodies, pairs);
  report["notes"] = notes;
  report["time_ms"] = {{"import", import_ms}, {"build", build_ms}, {"query", watch.lap()}};

  if (out)
    out->fill([&] {
      progress.step("maps");
      write_maps(command, bodies, *out);
      report["time_ms"]["maps"] = watch.lap();
      write_text(out->staging() / "report.json", to_text(report));
    });
  print(
      command, [&] { return report; }, [&] { return bodies_summary(command, bodies, pairs, notes); });
}

void add_options(CLI::App& app, BodiesCommand& c) {
  app.add_option("FILE", c.files,
                 fmt::format("One mesh per body ({}), at least two", sdm::mesh_format_names()))
      ->required()
      ->expected(2, CLI::detail::expected_max_vector_size);
  add_output_option(app, c.out)
      ->required(false)
      ->description("Output folder for the map of each body to all others, created if missing");
  app.add_option("--max-distance", c.max_distance, "Omit pairs, and texels, farther apart than D")
      ->check(positive_number())
      ->type_name("D");
  add_declared_options(app, c.options);
  add_units_option(app, c.units);
  app.add_option("--poses", c.poses,
                 "A text file with a pose per body and line: x y z and a quaternion w x y z, or a 4×4 "
                 "matrix, row by row")
      ->type_name("FILE");
  add_write_option(app, c.map_files, false);
  add_side_option(app, c.atlas, "all bodies' maps, which -o writes");
  add_run_options(app, c, "JSON instead of a table");
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
      "Examples, all pairs closer than 5, and three bodies of one shape in poses:\n"
      "  sdm bodies part1.stl part2.stl housing.stl --max-distance 5\n"
      "  sdm bodies gear.stl gear.stl gear.stl --poses poses.txt --contact-margin 0.1 --json");
  const auto command = std::make_shared<BodiesCommand>();
  add_options(*bodies, *command);
  bodies->callback([command] {
    for (const std::string& file : command->files) check_units(command->units, file, "");
    run(*command);
  });
}
