// closest_points() for points of several distributions against Mantis (https://github.com/Janos95/mantis),
// which is no part of this project: configure with -DSDM_MANTIS=FOLDER, that of its sources. Both compute on
// one thread; Mantis in single precision, and one point after another, as its interface has it. A distance of
// Mantis may be longer by 1e-5, as the longest side of the mesh is 1; `wrong_points` counts those that differ
// by more, and `error` is the largest difference.
//
//   build/dev/bench/mantis_points [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <mantis.h>
#include <sdm/closest_points.h>
#include <sdm/execution.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

#include "harness.h"
#include "point_sets.h"
#include "scenes.h"
#include "timing.h"

namespace sdm::bench {
namespace {

using MantisMesh = mantis::AccelerationStructure;

std::vector<std::array<float, 3>> single_precision(const std::vector<Vec3>& points) {
  std::vector<std::array<float, 3>> result;
  for (const Vec3& p : points)
    result.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  return result;
}

/// The mesh, and its Mantis, which takes seconds to build: made once for all cases.
struct Subject {
  Mesh mesh = load("armadillo.off", "fit");
  double build_ms = 0;
  std::unique_ptr<MantisMesh> mantis;

  Subject() {
    const auto begin = std::chrono::steady_clock::now();
    mantis = std::make_unique<MantisMesh>(single_precision(mesh.positions), mesh.triangles);
    build_ms = std::chrono::duration < double;
    std::milli > (std::chrono::steady_clock::now() - begin).count();
  }
};

const Subject& subject() {
  static const Subject made;
  return made;
}

struct Difference {
  double wrong_points = 0, error = 0;
};

Difference difference(const std::vector<ClosestPoint>& ours, const std::vector<float>& squares) {
  Difference result;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const double error = std::abs(ours[i].distance - std::sqrt(static_cast<double>(squares[i])));
    result.error = std::max(result.error, error);
    if (error > 1e-5) ++result.wrong_points;
  }
  return result;
}

Outcome against_mantis(const Trial& trial, const PointSet& set) {
  const ThreadLimit limit(trial.threads);
  const Mesh& mesh = subject().mesh;
  const Sites sites(mesh);
  const std::vector<Vec3> points = set.points(mesh, 100'000);
  const auto singles = single_precision(points);
  std::vector<ClosestPoint> ours;
  std::vector<float> squares(points.size());
  const Contender cpu{[&] { ours = closest_points(sites, points); }, trial.threads};
  const Contender peer{[&] {
                         for (std::size_t i = 0; i < singles.size(); ++i)
                           squares[i] = subject().mantis->calc_closest_point(singles[i]).distance_squared;
                       },
                       trial.threads};
  cpu.work();
  peer.work();
  const Difference found = difference(ours, squares);
  const Race times = race(cpu, peer, trial.repetitions);
  const auto count = static_cast<double>(points.size());
  return {.verified = found.wrong_points < 1e-3 * count,
          .rows = {{"",
                    {{"ratio", times.ratio},
                     {"spread", times.spread},
                     {"point_us", 1e3 * times.ours_ms / count},
                     {"mantis_us", 1e3 * times.peer_ms / count},
                     {"wrong_points", found.wrong_points},
                     {"error", found.error}}}},
          .counts = {{"points", count}}};
}

/// How long the structures of both take to build.
Outcome builds(const Trial& trial) {
  const ThreadLimit limit(trial.threads);
  const Contender cpu{[&] { const Sites sites(subject().mesh); }, trial.threads};
  const auto times = take_turns({&cpu, 1}, trial.repetitions);
  return {.verified = true,
          .rows = {{"", {{"build_ms", median(times[0])}, {"mantis_ms", subject().build_ms}}}}};
}

std::vector<Case> cases() {
  std::vector<Case> result;
  for (const PointSet& set : point_sets())
    result.push_back({.name = set.name,
                      .description = std::string(set.description) + "; an armadillo of 52k triangles",
                      .run = [set](const Trial& trial) { return against_mantis(trial, set); },
                      .repetitions = 5});
  result.push_back({.name = "build", .description = "the structure for the same armadillo", .run = builds});
  return result;
}

}  // namespace

Program program() {
  return {.name = "mantis_points",
          .description = "Closest points of scattered points, against Mantis",
          .repetition = "repetitions",
          .cases = cases()};
}

}  // namespace sdm::bench
