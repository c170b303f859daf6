// Figure 8: time per frame of maps at 512² and of volumes at 180 × 150 × 256, on the letters.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/stopwatch.h"
#include "research/figures/charts/chart.h"
#include "research/figures/figures.h"
#include "research/figures/maps.h"
#include "research/figures/pieces.h"
#include "research/figures/resolution_study.h"
#include "research/figures/timing.h"

namespace sdm::figures {
namespace {

/// A way to get the distances of both bodies to each other.
struct Contender {
  std::string key{}, name{};
  std::vector<double> ms{};        ///< of each frame; NaN: not measured
  double bytes = 0;                ///< of the values of both bodies
  double nearest = 0, linear = 0;  ///< errors on the surfaces, in the frame of the closest approach
  double separation_error = 0;     ///< of the smallest value on the surface, in the same frame

  [[nodiscard]] Times times() const {
    Times times;
    for (const double t : ms)
      if (std::isfinite(t)) times.add(t);
    return times;
  }
};

/// Meshes, sites and points of the surfaces in one frame.
struct Frame {
  std::array<Mesh, 2> meshes;
  std::array<Sites, 2> sites;
  double separation;

  Frame(const Recording& recording, std::size_t index)
      : meshes(recording.meshes(index)),
        sites{Sites(meshes[0]), Sites(meshes[1])},
        separation(ProximityQuery(meshes[0], meshes[1]).separation().value) {}
};

/// The last frame before the bodies touch, where an error of the separation shows.
std::size_t closest_approach(const Recording& recording) {
  ProximityQuery query(recording.first[0], recording.first[1]);
  for (std::size_t i = 1; i < recording.frames.size(); ++i) {
    query.refit(recording.frames[i][0], recording.frames[i][1]);
    if (query.separation().value == 0) return i - 1;
  }
  return recording.frames.size() - 1;
}

using Grids = std::array<Grid, 2>;

/// The grid of the paper over the bounds of both bodies, for each body's field; its axis of 256 points is
/// that in which the bodies are largest.
Grid paper_grid(const Box& box, double share) {
  std::array<int, 3> axes{0, 1, 2};
  std::ranges::sort(axes, {}, [&](int k) { return box.upper[k] - box.lower[k]; });
  const std::array<double, 3> points{150, 180, 256};
  std::array<std::uint32_t, 3> dims{};
  for (int i = 0; i < 3; ++i) dims[axes[i]] = static_cast<std::uint32_t>(std::lround(share * points[i]));
  return make_grid(box, dims);
}

Contender measure_volume(Run& run, const Recording& recording, const std::vector<std::size_t>& frames,
                         const Frame& closest, const std::array<SurfacePoints, 2>& points, std::size_t shown,
                         fields::Method method, double share, double band) {
  const std::string name(fields::info(method).name);
  Contender contender{.key = name + (share < 1 && method == fields::Method::brute_force ? "_coarse" : ""),
                      .name = "volume, " + name,
                      .ms = std::vector<double>(recording.frames.size(), std::nan(""))};
  if (band < std::numeric_limits<double>::infinity())
    contender.name += fmt::format(", band of {:.3g} m", band);
  const auto fields_of = [&](const std::array<Sites, 2>& sites, const Grid& grid) {
    std::array<fields::Field, 2> result;
    for (int b = 0; b < 2; ++b)
      result[b] = fields::compute_field(sites[b], grid,
                                        {.method = method, .sign = SignMethod::none, .max_distance = band});
    return result;
  };
  const auto grid_of = [&](std::size_t frame) {
    return paper_grid(with_room(recording.bounds_of(frame)), share);
  };
  std::array<Sites, 2> sites{Sites(recording.first[0]), Sites(recording.first[1])};
  for (const std::size_t frame : frames) {
    run.step("figure8");
    for (int b = 0; b < 2; ++b) sites[b].refit(recording.frames[frame][b]);
    const Grid grid = grid_of(frame);
    Stopwatch watch;
    const auto fields = fields_of(sites, grid);
    contender.ms[frame] = watch.lap();
    contender.bytes = static_cast<double>(fields[0].report.field_bytes + fields[1].report.field_bytes);
  }
  const auto fields = fields_of(closest.sites, grid_of(shown));
  double least = std::numeric_limits<double>::infinity();
  for (int b = 0; b < 2; ++b) {
    const SurfaceErrors e = errors_of_field(fields[1 - b], points[b]);
    contender.nearest = std::max(contender.nearest, e.nearest);
    contender.linear = std::max(contender.linear, e.linear);
    const fields::Proximity proximity = fields::proximity(fields[1 - b], closest.meshes[b]);
    if (std::isfinite(proximity.separation.value))
      least = std::min(least, std::abs(proximity.separation.value));
  }
  contender.separation_error = std::abs(least - closest.separation);
  return contender;
}

Contender measure_map(Run& run, const Recording& recording, const std::vector<std::size_t>& frames,
                      const Frame& closest, const std::array<SurfacePoints, 2>& points, std::size_t shown,
                      const std::shared_ptr<const Engine>& engine, std::uint32_t resolution) {
  Contender contender{.key = engine ? "map_gl" : "map_cpu",
                      .name = engine ? "maps, gl engine" : "maps, cpu engine",
                      .ms = std::vector<double>(recording.frames.size(), std::nan(""))};
  Pair pair(recording.first, resolution);
  pair.compute(engine);
  for (const std::size_t frame : frames) {
    run.step("figure8");
    pair.refit(recording.frames[frame]);
    Stopwatch watch;
    pair.compute(engine);
    contender.ms[frame] = watch.lap();
  }
  pair.refit(recording.frames[shown]);
  pair.compute(engine);
  float least = std::numeric_limits<float>::infinity();
  for (int b = 0; b < 2; ++b) {
    const SurfaceErrors e = errors_of_map(pair.sides[b].surface, pair.sides[b].map, points[b]);
    contender.nearest = std::max(contender.nearest, e.nearest);
    contender.linear = std::max(contender.linear, e.linear);
    contender.bytes += bytes_of(pair.sides[b].map);
    for (const float d : pair.sides[b].map.distance)
      if (std::isfinite(d)) least = std::min(least, d);
  }
  contender.separation_error = std::abs(least - closest.separation);
  return contender;
}

/// About `count` frames at equal distances.
std::vector<std::size_t> some_frames(std::size_t frames, std::size_t count) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < count; ++i) result.push_back(i * frames / count);
  return result;
}

}  // namespace

Figure figure8(Run& run) {
  const Recording& letters = run.letters();
  const std::uint32_t resolution = run.choose(512u, 128u);
  const double share = run.choose(1.0, 1.0 / 6);
  const std::size_t shown = closest_approach(letters);
  const Frame closest(letters, shown);
  std::array<SurfacePoints, 2> points;
  for (int b = 0; b < 2; ++b)
    points[b] = surface_points(closest.meshes[b], closest.sites[1 - b], run.choose(20000u, 3000u));
  const double infinite = std::numeric_limits<double>::infinity();
  const double unit = Pair(letters.first, 64).diagonal(), band = 0.05 * unit;

  const std::vector<std::size_t> many = some_frames(letters.frames.size(), run.choose(50u, 4u)),
                                 some = some_frames(letters.frames.size(), run.choose(10u, 2u)),
                                 few = some_frames(letters.frames.size(), run.choose(3u, 1u));
  std::vector<Contender> contenders;
  const auto add_map = [&](const std::shared_ptr<const Engine>& engine) {
    contenders.push_back(measure_map(run, letters, many, closest, points, shown, engine, resolution));
  };
  const auto add_volume = [&](fields::Method method, const std::vector<std::size_t>& frames, double of_points,
                              double within) {
    contenders.push_back(
        measure_volume(run, letters, frames, closest, points, shown, method, of_points, within));
  };
  add_map(nullptr);
  if (run.gl) add_map(run.gl);
  add_volume(fields::Method::best, some, share, infinite);
  add_volume(fields::Method::linear_factorization, some, share, infinite);
  add_volume(fields::Method::difi, few, share, infinite);
  add_volume(fields::Method::csc, few, share, band);
  add_volume(fields::Method::brute_force, few, share / 4, infinite);
  contenders.back().name += ", a quarter of the points a side";

  const auto find = [&](const std::string& key) -> const Contender& {
    return *std::ranges::find(contenders, key, &Contender::key);
  };
  const double map_ms = find("map_cpu").times().median(), best_ms = find("best").times().median(),
               factorization_ms = find("linear_factorization").times().median();
  const Grid grid = paper_grid(with_room(letters.bounds_of(0)), share);
  Chart chart{.title = fmt::format("Time per frame: maps of {}², volumes of {} × {} × {}", resolution,
                                   grid.dims[0], grid.dims[1], grid.dims[2]),
              .x = {.label = "frame (60 per second)"},
              .y = {.label = "time for both bodies (ms)", .log = true}};
  std::vector<std::vector<std::string>> rows;
  Json measured{{"resolution", resolution}, {"grid", grid.dims}, {"frame_of_errors", shown}};
  for (const Contender& c : contenders) {
    Series series{.name = c.name};
    for (std::size_t i = 0; i < c.ms.size(); ++i)
      if (std::isfinite(c.ms[i])) {
        series.x.push_back(static_cast<double>(i));
        series.y.push_back(c.ms[i]);
      }
    chart.series.push_back(std::move(series));
    const Times times = c.times();
    rows.push_back({c.name, times.text(), fmt::format("{:.3g}×", times.median() / map_ms),
                    fmt::format("{:.3g} MB", c.bytes / 1e6), fmt::format("{:.2e}", c.nearest / unit),
                    fmt::format("{:.2e}", c.linear / unit),
                    fmt::format("{:.2e}", c.separation_error / unit)});
    measured[c.key] = {{"frame_ms", to_json(times)},
                       {"bytes", c.bytes},
                       {"error_nearest", c.nearest / unit},
                       {"error_linear", c.linear / unit},
                       {"separation_error", c.separation_error / unit}};
  }
  measured["speedup_over_linear_factorization_ms"] = factorization_ms / map_ms;
  measured["speedup_over_best_volume_ms"] = best_ms / map_ms;
  std::string gl_text;
  if (run.gl) {
    const double ratio = factorization_ms / find("map_gl").times().median();
    measured["gl_speedup_over_linear_factorization_ms"] = ratio;
    gl_text = fmt::format(
        " The maps by the paper's own algorithm, on {}, take {}: linear factorization takes {:.2g} times as "
        "long.",
        run.machine.gl_text(), find("map_gl").times().text(), ratio);
  }
  const double nearest_ratio = find("linear_factorization").nearest / find("map_cpu").nearest,
               linear_ratio = find("linear_factorization").linear / find("map_cpu").linear;
  Figure figure{
      .key = "figure8",
      .title = "Figure 8: maps against volumes",
      .paper =
          "Proximity of the two deforming letters (3.7K polygons): surface distance maps at 512 × 512 are "
          "5–10 times as fast as linear factorization [SGGM06] at 180 × 150 × 256, and more accurate on the "
          "surface.",
      .measured = fmt::format(
          "Maps of both letters at {}² by the cpu engine take {}; the fields of both letters at {} × {} × {} "
          "take {} by linear factorization and {} by our fastest method: {:.3g} and {:.3g} times as long.{} "
          "All volumetric methods run on the processor here, with the data flow of their papers. On the "
          "surfaces, in the last frame before contact, the largest error of the nearest value of the volume "
          "is {:.2g} times that of the maps; with linear interpolation, and with the closest points that "
          "maps store, {:.2g} times. The volume takes {:.2g} times the memory of the maps.",
          resolution, find("map_cpu").times().text(), grid.dims[0], grid.dims[1], grid.dims[2],
          find("linear_factorization").times().text(), find("best").times().text(), factorization_ms / map_ms,
          best_ms / map_ms, gl_text, nearest_ratio, linear_ratio,
          find("linear_factorization").bytes / find("map_cpu").bytes)};
  figure.html = {panel(to_svg(chart), ""),
                 table({"method", "time per frame, both bodies", "relative", "memory", "error, nearest",
                        "error, linear", "error of the separation"},
                       rows),
                 paragraph("Errors are relative to the diagonal of both letters; those of the separation, of "
                           "the smallest value found on the surfaces, before bounds are considered. CSC has "
                           "values within its band only.")};
  std::string speedups =
      fmt::format("{:.3g} times as fast, both on the processor", factorization_ms / map_ms);
  if (run.gl)
    speedups += fmt::format("; gl engine: {:.2g} times{}", factorization_ms / find("map_gl").times().median(),
                            run.machine.gl_software ? " (software, no GPU)" : "");
  figure.comparisons = {{"Maps against linear factorization, letters", "5–10 times as fast", speedups}};
  figure.json = {{"paper", {{"resolution", 512}, {"grid", {180, 150, 256}}, {"speedup", {5, 10}}}},
                 {"measured", measured}};
  return figure;
}

}  // namespace sdm::figures
