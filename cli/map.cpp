#include "map.h"

#include "alignment.h"
#include "atlas_cache.h"
#include "atlas_parts.h"
#include "common_options.h"
#include "format.h"
#include "map_files.h"
#include "map_options.h"
#include "notes.h"
#include "output_folder.h"
#include "progress_line.h"
#include "report.h"
#include "stopwatch.h"
#include "tile_totals.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace {

// NOLINTNEXTLINE(bugprone-exception-escape): moving JSON does not throw
struct Result {
  Outcome outcome;
  nlohmann::ordered_json report;
};

/// What map.exr says about itself.
std::vector<std::pair<std::string, std::string>> exr_attributes(const Input& on, const Input& to,
                                                                const sdm::SignUsed& sign,
                                                                const std::string& units) {
  std::vector<std::pair<std::string, std::string>> attributes{{"measuredOn", on.file},
                                                              {"distanceTo", to.file},
                                                              {"sign", sign_name(sign.method)},
                                                              {"signReason", sign.reason}};
  if (!on.transform.empty()) attributes.emplace_back("measuredOnTransform", on.transform);
  if (!to.transform.empty()) attributes.emplace_back("distanceToTransform", to.transform);
  if (!units.empty()) attributes.emplace_back("units", units);
  return attributes;
}

sdm::AtlasOptions atlas_options(const MapCommand& command, const sdm::Mesh& mesh) {
  sdm::AtlasOptions options = command.atlas;
  if (command.precision) options.resolution = sdm::resolution_for(mesh, options, *command.precision);
  return options;
}

/// The map of a mesh, or of a part of it, and what it takes to write it.
struct Computed {
  Result result;
  std::unique_ptr<sdm::Surface> surface;
  std::vector<float> at_vertices;
  sdm::DistanceMap map;
  double ms = 0;
};

/// One scale of colours and grey values for all tiles, unless it is given: that of their distances together.
class SharedScale {
 public:
  void add(const sdm::DistanceMap& map) {
    for (const float d : map.distance)
      if (std::isfinite(d)) lo_ = std::min(lo_, d), hi_ = std::max(hi_, d);
  }
  void set(sdm::PictureOptions& picture) const {
    if (!(lo_ < hi_)) return;
    if (const auto& tolerance = picture.tolerance;
        tolerance && picture.colormap == sdm::Colormap::automatic) {
      picture.range = {std::min<double>(lo_, tolerance->lo), std::max<double>(hi_, tolerance->hi)};
      return;
    }
    if (picture.colormap == sdm::Colormap::automatic)
      picture.colormap = lo_ < 0 && hi_ > 0 ? sdm::Colormap::diverging : sdm::Colormap::viridis;
    const double most = std::max(std::abs(lo_), std::abs(hi_));
    if (picture.colormap == sdm::Colormap::diverging)
      picture.range = {-most, most};
    else
      picture.range = {double{lo_}, double{hi_}};
  }

 private:
  float lo_ = std::numeric_limits<float>::infinity(), hi_ = -lo_;
};

/// Computes the map on `on`, or a part of it, of the distances to `to`. `sites`: of `to`; built if it is
/// null.
Computed compute(const MapCommand& command, Input& on, Input& to, const AtlasPart& part,
                 std::unique_ptr<sdm::Sites>& sites, double import_ms) {
  const sdm::Mesh& mesh = part.mesh ? *part.mesh : on.mesh;
  Stopwatch total;
  Computed computed;
  std::unique_ptr<sdm::Surface>& surface = computed.surface;
  std::vector<float>& at_vertices = computed.at_vertices;
  sdm::DistanceMap& map = computed.map;
  Outcome& outcome = computed.result.outcome;
  outcome.time.import = import_ms;

  sdm::run_concurrently({
      [&] {
        Stopwatch watch;
        surface = std::make_unique<sdm::Surface>(
            cached_surface(mesh, atlas_options(command, mesh), command.atlas_cache));
        outcome.time.atlas = watch.lap();
      },
      [&] {
        Stopwatch watch;
        if (!sites) sites = std::make_unique<sdm::Sites>(to.mesh);
        outcome.time.sites = watch.lap();
        // While the atlas leaves a core idle. Without an inside it decides nothing.
        if (sdm::choose_sign(*sites, command.map.sign).method == sdm::SignMethod::exact)
          outcome.embedded = sdm::is_embedded(*sites);
        sdm::MapOptions options = command.map;
        options.progress = nullptr;  // the atlas reports
        at_vertices = sdm::distances_at_vertices(mesh, *sites, options);
      },
      [&] { inspect(on), inspect(to); },
  });

  const std::optional<sdm::Tolerance>& tolerance = command.picture.tolerance;
  if (tolerance && tolerance->needs_sign() &&
      sdm::choose_sign(*sites, command.map.sign).method == sdm::SignMethod::none)
    throw sdm::Error(fmt::format(
        "{}: the tolerance {}:{} differs by sign, but the distances are unsigned: {}; use one number, or "
        "another --sign",
        to.file, tolerance->lo, tolerance->hi, sdm::choose_sign(*sites, command.map.sign).reason));

  Stopwatch map_watch;
  map = sdm::compute_map(*surface, *sites, command.map);
  outcome.time.map = map_watch.lap();
  outcome.sign = map.sign;
  outcome.beyond_max_distance = map.beyond_max_distance;
  outcome.max_distance = command.map.max_distance;
  outcome.resolution = map.resolution, outcome.rows = map.rows();
  outcome.accuracy = sdm::engine_accuracy(sdm::engine_info(*command.map.engine), on.mesh, to.mesh);
  outcome.extremes = sdm::extremes(*surface, map, at_vertices);
  outcome.raster = sdm::gl_report(*command.map.engine);
  computed.ms = total.lap();
  return computed;
}

/// Writes all files of a map into `folder`, and adds its numbers and its report. `aligned`: how O1 was, if it
/// was.
void write_results(const MapCommand& command, Input& on, Input& to, const AtlasPart& part,
                   const sdm::Sites* sites, const std::optional<AlignOutcome>& aligned,
                   const std::filesystem::path& folder, ProgressLine& progress, Computed& computed) {
  const std::unique_ptr<sdm::Surface>& surface = computed.surface;
  const std::vector<float>& at_vertices = computed.at_vertices;
  const sdm::DistanceMap& map = computed.map;
  Outcome& outcome = computed.result.outcome;
  progress.step("export");
  Stopwatch export_watch;
  std::vector<std::uint8_t> boundary;
  if (!sites->closed()) {
    boundary = sdm::boundary_mask(*sites, map);
    outcome.boundary_texels = static_cast<std::size_t>(std::ranges::count(boundary, 1));
  }
  const sdm::ExrOptions exr{.layers = command.layers,
                            .boundary = boundary,
                            .sites = sites,
                            .attributes = exr_attributes(on, to, map.sign, command.picture.units)};
  sdm::PictureOptions picture = command.picture;
  if (std::isfinite(outcome.accuracy)) picture.accuracy = outcome.accuracy;
  outcome.distance = sdm::statistics(*surface, map);
  const sdm::PictureOptions fixed = sdm::fixed_colors(picture, outcome.distance);
  sdm::run_concurrently({
      [&] {
        write_map_files(folder, command.files, *surface, map, at_vertices, &to.mesh, picture, fixed, exr);
      },
      [&] {
        if (on.vertices) write_vertex_files(folder, command.files, *on.vertices, at_vertices);
      },
      [&] {
        outcome.numbers = map_numbers(*surface, map, outcome.distance,
                                      {on.mesh, on.info->components, on.names, part.source_face},
                                      command.bands, command.picture.tolerance, outcome.accuracy);
        outcome.error_bound = sdm::covering_radius(*surface);
      },
  });
  if (command.picture.tolerance) {
    outcome.tolerance = sdm::check_tolerance(*surface, map, at_vertices, outcome.error_bound,
                                             outcome.accuracy, *command.picture.tolerance);
  }
  outcome.size = size_of(sdm::bounds(on.mesh));
  outcome.notes = notes_on(on, to);
  if (outcome.distance.texels == 0)
    outcome.notes.push_back("no texel is within --max-distance; the map is empty");
  outcome.notes.insert(outcome.notes.end(), part.notes.begin(), part.notes.end());
  if (const std::size_t texels = surface->overlapping_texels(); texels > 0)
    outcome.notes.push_back(
        fmt::format("{} texels are covered by several faces, and have the value of one of them; --strict-uv "
                    "refuses that",
                    texels));
  if (aligned) std::ranges::copy(notes(*aligned), std::back_inserter(outcome.notes));
  outcome.time.output = export_watch.lap();
  outcome.time.total = outcome.time.import + computed.ms + outcome.time.output;

  const Input& o1 = on.role == "o1" ? on : to;
  const Input& o2 = on.role == "o1" ? to : on;
  nlohmann::ordered_json& report = computed.result.report;
  report["version"] = sdm::kVersion;
  report["o1"] = to_json(o1);
  report["o2"] = to_json(o2);
  report[to.role]["embedded"] = outcome.embedded ? nlohmann::ordered_json(*outcome.embedded) : nullptr;
  report["measured_on"] = on.role;
  report["units"] = command.picture.units;
  if (aligned) report["alignment"] = to_json(*aligned);
  report["atlas"] = to_json(*surface);
  report["atlas"]["udim"] = part.udim ? nlohmann::ordered_json(*part.udim) : nullptr;
  report["atlas"]["cut_faces"] = part.cut_faces;
  report["precision"] = command.precision ? nlohmann::ordered_json(*command.precision) : nullptr;
  report["engine"] = command.engine.name;
  report["max_distance"] = command.map.max_distance;  // null: no limit
  report["colors"] = colors_json(fixed, command.picture);
  report.update(to_json(outcome));
  const std::string text = to_text(report);
  if (command.files.html)
    sdm::write_html(folder / "report.html", *surface, map, at_vertices, text,
                    {.other = &to.mesh, .up = command.picture.up});
  write_text(folder / "report.json", text);
}

constexpr const char* kAlignmentFile = "alignment.json";

/// All files that any run of the command writes, with the UDIM tiles that there are in the folder.
std::vector<std::filesystem::path> stale_files(const std::filesystem::path& out) {
  std::vector<std::filesystem::path> files{kAlignmentFile};
  for (const std::filesystem::path mesh : {"", "o1", "o2"}) {
    std::vector<std::filesystem::path> folders{mesh};
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(out / mesh, ignored))
      if (const std::string name = entry.path().filename().string();
          name.size() == 4 && std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; }))
        folders.push_back(mesh / name);
    for (const std::filesystem::path& folder : folders) {
      for (const std::string& file : all_names()) files.push_back(folder / file);
      files.push_back(folder / "report.json");
    }
  }
  return files;
}

/// The maps of a mesh: one, or one for each UDIM tile.
struct MeshResults {
  std::string role;
  std::vector<AtlasPart> parts;
  std::vector<Result> results;  ///< of each part
  std::optional<Result> total;  ///< of several tiles

  [[nodiscard]] bool is_tiled() const { return parts.front().udim.has_value(); }
  /// Of the whole mesh.
  [[nodiscard]] Result& whole() { return total ? *total : results.front(); }
  [[nodiscard]] const Result& whole() const { return total ? *total : results.front(); }
  /// A report, or an object of the reports of the tiles and of all of them, `total`.
  [[nodiscard]] nlohmann::ordered_json report() const {
    if (!is_tiled()) return results.front().report;
    nlohmann::ordered_json tiles;
    for (std::size_t i = 0; i < parts.size(); ++i) tiles[std::to_string(*parts[i].udim)] = results[i].report;
    if (total) tiles["total"] = total->report;
    return tiles;
  }
};

// As many texels as a map of 8192² has are kept while the others are computed.
constexpr std::size_t kKeptTexels = std::size_t{1} << 26;

/// Computes the maps of a mesh. `sites`: of `to`, or null.
MeshResults measure_parts(MapCommand command, Input& on, Input& to, std::unique_ptr<sdm::Sites> sites,
                          const std::optional<AlignOutcome>& aligned, double import_ms, OutputFolder& out,
                          ProgressLine& progress) {
  MeshResults all{on.role, atlas_parts(on.mesh, command.atlas), {}, {}};
  const bool tiled = all.parts.size() > 1;
  if (tiled && !command.atlas_cache.empty())
    throw sdm::Error(fmt::format("{}: a mesh with {} UDIM tiles has no single atlas; omit --atlas-cache",
                                 on.file, all.parts.size()));
  // The scale is that of all tiles. Maps that are not kept until it is known are computed again.
  std::vector<std::optional<Computed>> kept(all.parts.size());
  if (tiled && !command.picture.range) {
    SharedScale scale;
    std::size_t texels = 0;
    for (std::size_t i = 0; i < all.parts.size(); ++i) {
      Computed computed = compute(command, on, to, all.parts[i], sites, import_ms);
      scale.add(computed.map);
      texels += computed.map.distance.size();
      if (texels <= kKeptTexels) kept[i] = std::move(computed);
    }
    scale.set(command.picture);
  }

  const std::filesystem::path folder = command.both ? on.role : "";
  TileTotals totals;
  for (std::size_t i = 0; i < all.parts.size(); ++i) {
    const AtlasPart& part = all.parts[i];
    const std::string tile = part.udim ? std::to_string(*part.udim) : "";
    Computed computed = kept[i] ? std::move(*kept[i]) : compute(command, on, to, part, sites, import_ms);
    kept[i].reset();
    write_results(command, on, to, part, sites.get(), aligned, out.staging(folder / tile), progress,
                  computed);
    if (tiled) totals.add(*part.udim, computed.result.outcome, *computed.surface, computed.map);
    all.results.push_back(std::move(computed.result));
  }
  if (!tiled) return all;
  all.total = Result{totals.finish(), {}};
  nlohmann::ordered_json& report = all.total->report;
  for (const char* key : {"version", "o1", "o2", "measured_on", "units", "engine", "max_distance"})
    report[key] = all.results.front().report[key];
  report.update(totals.report());
  write_text(out.staging(folder) / "report.json", to_text(report));
  return all;
}

/// The lines that are printed of the maps of a mesh.
std::string lines_of(const MeshResults& mesh, const Input& on, const Input& to, const std::string& units) {
  std::string text;
  for (std::size_t i = 0; i < mesh.parts.size(); ++i) {
    if (mesh.parts[i].udim) text += fmt::format("tile {}: ", *mesh.parts[i].udim);
    text += summary(on, to, mesh.results[i].outcome, units);
  }
  if (mesh.total)
    text += fmt::format("all {} tiles: ", mesh.parts.size()) + summary(on, to, mesh.total->outcome, units);
  return text;
}

/// Returns the exit code.
int run(MapCommand command) {
  Stopwatch total;
  limit_threads(command.threads);
  OutputFolder out(command.out, [&] { return stale_files(command.out); });
  ProgressLine progress(command.quiet);
  command.atlas.progress = command.map.progress = progress.callback();
  command.map.engine = make_engine(command.engine, command.gl, command.atlas);

  progress.step("import");
  Stopwatch import;
  Input o1, o2;
  const bool vertices = command.files.any_vertices();
  sdm::run_concurrently(
      {[&] { o1 = load_input("o1", command.o1, command.transform_o1, {vertices}); },
       [&] { o2 = load_input("o2", command.o2, command.transform_o2, {vertices && command.both}); }});
  const double import_ms = import.lap();

  std::optional<AlignOutcome> aligned;
  std::vector<MeshResults> meshes;
  out.fill([&] {
    std::unique_ptr<sdm::Sites> sites;
    if (command.align.on) {
      progress.step("align");
      sites = std::make_unique<sdm::Sites>(o2.mesh);
      aligned = align_mesh(o1.mesh, *sites, command.align, progress.callback());
      write_text(out.staging() / kAlignmentFile, to_text(to_json(*aligned)));
    }
    meshes.push_back(measure_parts(command, o1, o2, std::move(sites), aligned, import_ms, out, progress));
    if (!command.both) return;
    meshes.push_back(measure_parts(command, o2, o1, nullptr, aligned, import_ms, out, progress));
    add_symmetric_hausdorff(meshes[0].whole().report, meshes[1].whole().report);
    for (const MeshResults& mesh : meshes) {
      const std::string tile = mesh.is_tiled() && !mesh.total ? std::to_string(*mesh.parts[0].udim) : "";
      write_text(out.staging(mesh.role + "/" + tile) / "report.json", to_text(mesh.whole().report));
    }
  });

  if (command.json) {
    std::cout << to_text(command.both
                             ? nlohmann::ordered_json{{"o1", meshes[0].report()}, {"o2", meshes[1].report()}}
                             : meshes[0].report());
  } else if (!command.quiet) {
    for (const MeshResults& mesh : meshes)
      std::cout << lines_of(mesh, mesh.role == "o1" ? o1 : o2, mesh.role == "o1" ? o2 : o1,
                            command.picture.units);
    if (aligned) std::cout << summary(*aligned, command.picture.units);
    std::string tiles;
    for (const AtlasPart& part : meshes[0].parts)
      if (part.udim) tiles += fmt::format("{}{}", tiles.empty() ? "" : ",", *part.udim);
    std::cout << fmt::format(
        "  time      {} s\n  results   {}{}{}/: {}report.json\n", number(std::round(total.lap()) / 1000, 6),
        command.out.string(), command.both ? "/{o1,o2}" : "", tiles.empty() ? "" : "/{" + tiles + "}",
        (aligned && !command.both ? kAlignmentFile + std::string(" ") : "") + listed(command.files));
  }
  const bool all_within = std::ranges::all_of(meshes, [](const MeshResults& mesh) {
    const auto& tolerance = mesh.whole().outcome.tolerance;
    return !tolerance || tolerance->within;
  });
  return all_within ? 0 : 3;
}

}  // namespace

void add_map_command(CLI::App& app) {
  CLI::App* map = app.add_subcommand("map", "Compute the distance from every point of mesh O1 to mesh O2");
  map->footer(
      "Writes map.exr (all values), distance.png, voronoi.png, direction.png, model.glb (O1 in colours), "
      "report.html (a page that shows all of it) and report.json.\n"
      "Exit codes: 0 success, 1 failure, 2 invalid usage, 3 tolerance exceeded. An interrupt terminates sdm "
      "with its signal.\n\n"
      "Example, two meshes side by side:\n"
      "  sdm map bunny.obj armadillo.off -o out --transform-o1 fit --transform-o2 fit,translate:0.8:0:0");
  const auto command = std::make_shared<MapCommand>();
  add_options(*map, *command);
  map->callback([map, command] {
    check_combination(*map, *command);
    if (const int code = run(*command); code != 0) throw CLI::RuntimeError(code);
  });
}
