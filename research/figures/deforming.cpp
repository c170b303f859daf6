#include "research/figures/deforming.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/stopwatch.h"
#include "research/figures/charts/chart.h"
#include "research/figures/maps.h"
#include "research/figures/pieces.h"

namespace sdm::figures {
namespace {

std::size_t frame_to_show(const Deforming& result) {
  for (std::size_t i = 0; i < result.depth.size(); ++i)
    if (result.depth[i] > 0) return i;
  return static_cast<std::size_t>(std::ranges::min_element(result.separation) - result.separation.begin());
}

}  // namespace

Deforming run_frames(Run& run, const Recording& recording, std::uint32_t resolution) {
  Deforming result{.frames = recording.frames.size()};
  const AtlasOptions atlas{.resolution = resolution};
  ProximityQuery query(Shape(recording.first[0], atlas), Shape(recording.first[1], atlas));
  std::array<DistanceMap, 2> maps;
  // The gl engine maps eight frames only: where it runs on the processor, it takes its time.
  const std::size_t gl_stride = std::max<std::size_t>(1, recording.frames.size() / 8);
  const auto compute = [&](const std::shared_ptr<const Engine>& engine) {
    for (int b = 0; b < 2; ++b)
      compute_map(query.surface(b), query.sites(1 - b), {.engine = engine, .sign = SignMethod::none},
                  maps[b]);
  };
  compute(nullptr);  // allocates
  if (run.gl) compute(run.gl);
  for (std::size_t frame = 0; frame < recording.frames.size(); ++frame) {
    run.step("frames");
    const auto& positions = recording.frames[frame];
    Stopwatch watch;
    query.refit(positions[0], positions[1]);
    result.update.add(watch.lap());
    compute(nullptr);
    result.maps.add(watch.lap());
    result.separation.push_back(query.separation().value);
    const auto& depth = query.penetration_depth();
    result.depth.push_back(depth ? depth->value : 0);
    (void)query.contacts().size();
    result.colliding += query.colliding();
    result.queries.add(watch.lap());
    if (run.gl && frame % gl_stride == 0) {
      watch.lap();
      compute(run.gl);
      result.gl_maps.add(watch.lap());
    }
  }
  for (int b = 0; b < 2; ++b) {
    result.triangles[b] = recording.first[b].triangles.size();
    result.texels += query.surface(b).sample_texels().size();
  }
  result.shown = frame_to_show(result);
  Pair pair(recording.first, resolution);
  pair.refit(recording.frames[result.shown]);
  if (run.gl) {
    pair.compute(run.gl);
    result.gl_error = pair.error_at_samples();
  }
  pair.compute();
  result.error = pair.error_at_samples();
  return result;
}

void show_frames(Figure& figure, const Recording& recording, const Deforming& result,
                 std::uint32_t resolution, bool directions) {
  constexpr std::uint32_t kPictureWidth = 320, kPictureHeight = 213;
  Pair pair(recording.first, resolution);
  const View view = view_of(recording.bounds_of(0), {0.25, -3, 0.7}, kPictureWidth, kPictureHeight);
  const io::Picture before = paint_bodies(pair, view);
  pair.refit(recording.frames[result.shown]);
  pair.compute();
  const View near =
      view_of(recording.bounds_of(result.shown), {0.25, -3, 0.7}, kPictureWidth, kPictureHeight);
  const MapPictures pictures = paint(pair, near);
  const std::string frame = fmt::format("frame {}", result.shown);
  std::vector<std::string> panels{panel(before, "(a) The bodies, frame 0"),
                                  panel(paint_bodies(pair, near), "(b) The bodies, " + frame)};
  if (directions) {
    panels.push_back(panel(pictures.direction, "(c) Direction to the closest point, " + frame));
    figure.html.push_back(row(panels));
    figure.html.push_back(direction_legend());
  } else {
    panels.push_back(panel(pictures.distance, "(c) Distance, " + frame));
    panels.push_back(panel(pictures.legend, "Distance"));
    figure.html.push_back(row(panels));
  }
  std::vector<double> frames(result.frames);
  for (std::size_t i = 0; i < frames.size(); ++i) frames[i] = static_cast<double>(i);
  figure.html.push_back(panel(
      to_svg({.title = "Separation and penetration depth, from the triangles",
              .x = {.label = "frame (60 per second)"},
              .y = {.label = "length (m)"},
              .series = {{.name = "separation", .x = frames, .y = result.separation, .dots = false},
                         {.name = "penetration depth", .x = frames, .y = result.depth, .dots = false}}}),
      ""));
  figure.html.push_back(table({"per frame", "median", "least", "most", "frames"}, [&] {
    std::vector<std::vector<std::string>> rows;
    const auto add = [&](const char* what, const Times& t) {
      if (t.empty()) return;
      rows.push_back({what, fmt::format("{:.2f} ms", t.median()), fmt::format("{:.2f} ms", t.least()),
                      fmt::format("{:.2f} ms", t.most()), fmt::to_string(t.runs())});
    };
    add("move the vertices", result.update);
    add("both maps, cpu engine", result.maps);
    add("all proximity queries", result.queries);
    add("both maps, gl engine", result.gl_maps);
    return rows;
  }()));
}

Json measured_json(const Run& run, const Deforming& result, std::uint32_t resolution) {
  return {{"triangles", {result.triangles[0], result.triangles[1]}},
          {"resolution", resolution},
          {"samples", result.texels},
          {"frames", result.frames},
          {"colliding_frames", result.colliding},
          {"frame_shown", result.shown},
          {"least_separation", *std::ranges::min_element(result.separation)},
          {"largest_depth", *std::ranges::max_element(result.depth)},
          {"error_at_samples", result.error},
          {"gl_error_at_samples", run.gl ? Json(result.gl_error) : Json(nullptr)},
          {"update_ms", to_json(result.update)},
          {"cpu_maps_ms", to_json(result.maps)},
          {"queries_ms", to_json(result.queries)},
          {"gl_maps_ms", to_json(result.gl_maps)}};
}

}  // namespace sdm::figures
