// Figure 1: a figure of 17.2k triangles in a box of 12, each mapped to the other at 256².
#include <fmt/format.h>

#include "research/figures/figures.h"
#include "research/figures/maps.h"
#include "research/figures/pieces.h"
#include "research/figures/timing.h"

namespace sdm::figures {

Figure figure1(Run& run) {
  constexpr std::uint32_t kResolution = 256;
  constexpr double kPaperMs = 600;
  const scenes::Scene scene(scenes::SceneKind::figure);
  Pair pair({scene.bodies()[0].mesh, scene.bodies()[1].mesh}, kResolution);

  std::vector<std::function<void()>> work{[&] { pair.compute(); }};
  if (run.gl) work.emplace_back([&] { pair.compute(run.gl); });
  std::vector<Times> times = take_turns(work, run.choose(9, 3));
  times.resize(2);
  const double gl_error = run.gl ? pair.error_at_samples() : 0;
  pair.compute();
  const double error = pair.error_at_samples();

  constexpr std::uint32_t kPictureWidth = 320, kPictureHeight = 512;
  const View view = view_of(bounds(scene.bodies()[1].mesh), {1.3, -3.1, 0.95}, kPictureWidth, kPictureHeight);
  const MapPictures pictures = paint(pair, view, true);

  Figure figure{
      .key = "figure1",
      .title = "Figure 1: a figure in a box",
      .paper =
          "The surface distance maps of the Hugo model (17.2K polygons) and the box around it (12), at 256 × "
          "256: (a) distance, red to green; (b) Voronoi diagrams; (c) directions. Computed in 600 ms on a "
          "GeForce 7800 GTX.",
      .measured = fmt::format(
          "The Hugo model is not public; the walking figure of `sdm scene figure` stands in for it, with {} "
          "triangles in a box of {}. Both maps together: {} by the cpu engine, {} by the gl engine. The "
          "largest error at any of {} samples is {} of the scene's diagonal (reference engine in double "
          "precision).",
          pair.sides[0].surface.mesh().triangles.size(), pair.sides[1].surface.mesh().triangles.size(),
          times[0].text(), times[1].text(), pair.texels(), magnitude(error))};
  figure.html = {
      row({panel(pictures.distance, "(a) Distance, of the figure to the box and of the box to the figure"),
           panel(pictures.legend, "Distance"), panel(pictures.voronoi, "(b) Voronoi diagrams"),
           panel(pictures.direction, "(c) Directions")}),
      voronoi_legend(), direction_legend()};
  figure.comparisons = {{"Both maps of a figure in a box, 256²", fmt::format("{} ms", kPaperMs),
                         both_engines(times[0], times[1], run.machine)}};
  figure.json = {
      {"paper", {{"triangles", {17200, 12}}, {"resolution", 256}, {"maps_ms", kPaperMs}}},
      {"measured",
       {{"triangles",
         {pair.sides[0].surface.mesh().triangles.size(), pair.sides[1].surface.mesh().triangles.size()}},
        {"resolution", kResolution},
        {"samples", pair.texels()},
        {"error_at_samples", error},
        {"cpu_maps_ms", to_json(times[0])},
        {"gl_error_at_samples", run.gl ? Json(gl_error) : Json(nullptr)},
        {"gl_maps_ms", to_json(times[1])}}}};
  return figure;
}

}  // namespace sdm::figures
