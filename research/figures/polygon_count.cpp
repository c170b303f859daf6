// Section 6.1: the time of a map against the number of polygons, at 512².
#include <fmt/format.h>

#include <algorithm>

#include "io/mesh/placement.h"
#include "research/figures/charts/chart.h"
#include "research/figures/figures.h"
#include "research/figures/maps.h"
#include "research/figures/pieces.h"
#include "research/figures/timing.h"
#include "scenes/bunny.h"
#include "scenes/reduce_mesh.h"

namespace sdm::figures {

Figure polygon_count(Run& run) {
  const std::uint32_t resolution = run.choose(512u, 128u);
  const std::vector<std::size_t> counts =
      run.quick ? std::vector<std::size_t>{1000, 2000, 4000}
                : std::vector<std::size_t>{1000, 2000, 5000, 10000, 20000, 50000};
  Mesh bunny = scenes::read_bunny(run.mesh);
  io::place(bunny, io::parse_placement("fit"));
  std::vector<double> polygons, cpu, gl;
  std::vector<std::vector<std::string>> rows;
  Json measured = Json::array();
  double error = 0;
  for (const std::size_t count : counts) {
    run.step("polygon_count");
    const Mesh o1 = scenes::reduce_mesh(bunny, count);
    Mesh o2 = o1;
    io::place(o2, io::parse_placement("rotate:0:90:0,translate:1.1:0:0"));
    Pair pair({o1, o2}, resolution);
    std::vector<std::function<void()>> work{[&] { pair.compute(); }};
    if (run.gl) work.emplace_back([&] { pair.compute(run.gl); });
    std::vector<Times> times = take_turns(work, run.choose(5, 2));
    times.resize(2);
    const auto sample_error = [&](const std::shared_ptr<const Engine>& engine) {
      pair.compute(engine);
      error = std::max(error, pair.error_at_samples());
    };
    if (count == counts.front()) sample_error(nullptr);
    if (count == counts.front() && run.gl) sample_error(run.gl);
    polygons.push_back(static_cast<double>(pair.triangles()));
    cpu.push_back(times[0].median());
    gl.push_back(times[1].empty() ? std::nan("") : times[1].median());
    rows.push_back({fmt::to_string(pair.triangles()), times[0].text(), times[1].text()});
    measured.push_back({{"polygons", pair.triangles()},
                        {"samples", pair.texels()},
                        {"cpu_maps_ms", to_json(times[0])},
                        {"gl_maps_ms", to_json(times[1])}});
  }
  Figure figure{.key = "polygon_count",
                .title = "Section 6.1: time against the number of polygons",
                .paper =
                    "Maps of 512² to 1K × 1K of objects with tens of thousands of polygons in a fraction of "
                    "a second; a graph, which the technical report lacks, for scenes of varying polygon "
                    "counts.",
                .measured = fmt::format(
                    "Two bunnies side by side, simplified to different numbers of triangles; both maps at "
                    "{}², without the layout of the atlas, which is precomputed as in the paper. From {} to "
                    "{} polygons the time grows by a factor of {:.2g} for the cpu engine{}.",
                    resolution, polygons.front(), polygons.back(), cpu.back() / cpu.front(),
                    run.gl ? fmt::format(", and of {:.2g} for the gl engine", gl.back() / gl.front()) : "")};
  Chart chart{.title = fmt::format("Both maps of two bunnies, {}²", resolution),
              .x = {.label = "polygons of both bodies", .log = true},
              .y = {.label = "time of both maps (ms)", .log = true},
              .series = {{.name = "cpu engine", .x = polygons, .y = cpu}}};
  if (run.gl) chart.series.push_back({.name = "gl engine", .x = polygons, .y = gl});
  figure.html = {panel(to_svg(chart), ""),
                 table({"polygons", "both maps, cpu engine", "both maps, gl engine"}, rows)};
  figure.comparisons = {{fmt::format("Both maps of {} polygons, {}²", polygons.back(), resolution),
                         "a fraction of a second (tens of thousands, 512² to 1K²)",
                         fmt::format("{:.3g} ms", cpu.back())}};
  figure.json = {
      {"paper", {{"resolution", {512, 1024}}}},
      {"measured", {{"resolution", resolution}, {"error_at_samples", error}, {"scenes", measured}}}};
  return figure;
}

}  // namespace sdm::figures
