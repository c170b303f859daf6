// The time of a frame of two deforming bodies, as in a simulation: new positions, all proximity queries, and
// the maps in both directions. A repetition is a frame. In every frame the queries are compared with the
// complete maps.
//
//   build/dev/bench/frames [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <sdm/execution.h>
#include <sdm/sdm.h>
#include "scenes/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/stopwatch.h"
#include "geometry/vec.h"
#include "harness.h"
#include "timing.h"

namespace sdm::bench {
namespace {

/// Two bodies, and the positions of both in each frame.
struct Motion {
  std::array<Mesh, 2> first;
  std::vector<std::array<std::vector<Vec3>, 2>> frames;

  Motion(scenes::SceneKind kind, int count) {
    scenes::Scene scene(kind);
    for (int b = 0; b < 2; ++b) first[b] = scene.bodies()[b].mesh;
    for (int i = 0; i < count; ++i) {
      frames.push_back({scene.bodies()[0].mesh.positions, scene.bodies()[1].mesh.positions});
      scene.advance();
    }
  }
};

/// Whether the results agree with the minima of both maps.
bool agree(ProximityQuery& query, const std::array<DistanceMap, 2>& maps) {
  double least = std::numeric_limits<double>::infinity(), deepest = 0;
  for (const DistanceMap& map : maps)
    for (const float d : map.distance) {
      if (std::isnan(d)) continue;
      least = std::min(least, std::abs(static_cast<double>(d)));
      deepest = std::max(deepest, -static_cast<double>(d));
    }
  Box box = bounds(query.surface(0).mesh());
  extend(box, bounds(query.surface(1).mesh()));
  const double tolerance = 2e-6 * diagonal(box);
  const BoundedLength &separation = query.separation(),
                      depth = query.penetration_depth().value_or(BoundedLength{});
  return separation.value <= least + tolerance && depth.upper >= deepest - tolerance &&
         depth.upper - depth.lower <= ProximityOptions::kDepthPrecision * diagonal(box) + tolerance;
}

/// Milliseconds of each frame.
struct Times {
  std::vector<double> update, queries, maps;
};

Row row(std::string name, const std::vector<double>& times) {
  return {std::move(name),
          {{"mean_ms", mean(times)}, {"median_ms", median(times)}, {"p99_ms", quantile(times, 0.99)}}};
}

std::vector<double> sum(std::vector<double> a, const std::vector<double>& b) {
  std::ranges::transform(a, b, a.begin(), std::plus());
  return a;
}

Outcome measure(const Trial& trial, scenes::SceneKind kind) {
  const Motion motion(kind, trial.repetitions);
  const ThreadLimit limit(trial.threads);
  const AtlasOptions atlas{.resolution = 512};
  ProximityQuery query(Shape(motion.first[0], atlas), Shape(motion.first[1], atlas));
  std::array<DistanceMap, 2> maps;
  Times times;
  std::size_t colliding = 0, contacts = 0;
  bool verified = true;
  const auto frame = [&](const std::array<std::vector<Vec3>, 2>& positions) {
    Stopwatch watch;
    query.refit(positions[0], positions[1]);
    times.update.push_back(watch.lap());
    (void)query.separation();
    (void)query.penetration_depth();
    contacts += query.contacts().size();
    colliding += query.colliding();
    times.queries.push_back(watch.lap());
    for (int b = 0; b < 2; ++b) compute_map(query.surface(b), query.sites(1 - b), {}, maps[b]);
    times.maps.push_back(watch.lap());
    verified &= agree(query, maps);
  };
  frame(motion.frames.front());  // performs all allocations
  times = {};
  colliding = contacts = 0;
  for (const auto& positions : motion.frames) frame(positions);

  const std::vector<double> answers = sum(times.update, times.queries);
  return {.verified = verified,
          .rows = {row("update", times.update), row("queries", times.queries), row("maps", times.maps),
                   row("update + queries", answers), row("all", sum(answers, times.maps))},
          .counts = {{"colliding_frames", static_cast<double>(colliding)},
                     {"contacts_per_frame", static_cast<double>(contacts) / trial.repetitions}}};
}

std::vector<Case> cases() {
  std::vector<Case> result;
  const auto add = [&](std::string name, scenes::SceneKind kind, const std::string& what) {
    result.push_back({.name = std::move(name),
                      .description = what + ", 512²",
                      .run = [=](const Trial& trial) { return measure(trial, kind); },
                      .repetitions = 150,
                      .threads = 0});
  };
  add("letters", scenes::SceneKind::letters, "the scene of two letters");
  add("bunnies", scenes::SceneKind::bunnies, "the scene of two bunnies");
  add("figure", scenes::SceneKind::figure, "the scene of a figure in a box");
  return result;
}

}  // namespace

Program program() {
  return {.name = "frames",
          .description = "Frames of two deforming bodies: update, all queries, the maps of both directions",
          .repetition = "frames",
          .cases = cases()};
}

}  // namespace sdm::bench
