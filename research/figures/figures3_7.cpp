// Figures 3 and 7: maps and proximity queries of deforming letters and bunnies at 512².
#include <fmt/format.h>

#include "research/figures/deforming.h"
#include "research/figures/figures.h"
#include "research/figures/pieces.h"

namespace sdm::figures {
namespace {

constexpr std::uint32_t kFull = 512, kQuick = 256;

std::string measured_text(const Deforming& r, std::uint32_t resolution) {
  return fmt::format(
      "{} and {} triangles, {} frames at {}²: both maps take {} by the cpu engine, and {} by the gl engine; "
      "all proximity queries {}. The maps are global, as in the paper. The queries do not scan them: "
      "separation, collision, depth and contacts are computed from the triangles, so they have no error of "
      "sampling. In {} frames the bodies collide. The largest error of the maps at their samples is {} of "
      "the diagonal.",
      r.triangles[0], r.triangles[1], r.frames, resolution, r.maps.text(), r.gl_maps.text(), r.queries.text(),
      r.colliding, magnitude(r.error));
}

}  // namespace

Figure figure3(Run& run) {
  const std::uint32_t resolution = run.choose(kFull, kQuick);
  const Deforming result = run_frames(run, run.letters(), resolution);
  Figure figure{.key = "figure3",
                .title = "Figure 3: deforming letters",
                .paper =
                    "Two deforming letters \"E\" and \"G\" (3.7K triangles in total): two frames, and the "
                    "directions to the closest points. Global distance maps at 512 × 512 in 100 ms; "
                    "proximity queries, by read-back and scanning, about 10 ms more.",
                .measured =
                    "The letters of the paper are not public; those of `sdm scene letters` stand in for "
                    "them. " +
                    measured_text(result, resolution)};
  show_frames(figure, run.letters(), result, resolution, true);
  figure.comparisons = {{fmt::format("Letters, both maps, {}²", resolution), "100 ms (512²)",
                         both_engines(result.maps, result.gl_maps, run.machine)},
                        {"Letters, proximity queries", "10 ms", result.queries.median_text()}};
  figure.json = {
      {"paper", {{"triangles", {2100, 1600}}, {"resolution", 512}, {"maps_ms", 100}, {"queries_ms", 10}}},
      {"measured", measured_json(run, result, resolution)}};
  return figure;
}

Figure figure7(Run& run) {
  const std::uint32_t resolution = run.choose(kFull, kQuick);
  const Deforming result = run_frames(run, run.bunnies(), resolution);
  Figure figure{
      .key = "figure7",
      .title = "Figure 7: deforming bunnies",
      .paper =
          "Two deforming bunnies of 2K triangles each: two frames, and the distance on both, red to green. "
          "Distance maps and proximity queries in 300–320 ms at 512 × 512.",
      .measured =
          "The bunny of glmark2-data, simplified and simulated by `sdm scene bunnies`, stands in for the "
          "paper's. " +
          measured_text(result, resolution)};
  show_frames(figure, run.bunnies(), result, resolution, false);
  figure.comparisons = {{fmt::format("Bunnies, both maps, {}²", resolution), "300–320 ms with queries (512²)",
                         both_engines(result.maps, result.gl_maps, run.machine)},
                        {"Bunnies, proximity queries", "included", result.queries.median_text()}};
  figure.json = {
      {"paper", {{"triangles", {2000, 2000}}, {"resolution", 512}, {"maps_and_queries_ms", {300, 320}}}},
      {"measured", measured_json(run, result, resolution)}};
  return figure;
}

}  // namespace sdm::figures
