// closest_points() for points of several distributions, and for few and many of them, against the reference
// engine: a scalar best-first search for each point. All distances are compared first.
//
//   build/dev/bench/scattered_points [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <sdm/closest_points.h>
#include <sdm/execution.h>

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "geometry/vec.h"
#include "harness.h"
#include "point_sets.h"
#include "refine_mesh.h"
#include "scenes.h"
#include "timing.h"

namespace sdm::bench {
namespace {

Outcome scattered(const Trial& trial, const Mesh& mesh, std::span<const Vec3> points) {
  const ThreadLimit limit(trial.threads);
  const Sites sites(mesh);
  std::vector<ClosestPoint> ours, reference;
  const ClosestPointOptions by_reference{.engine = make_engine("reference")};
  const Contender cpu{[&] { ours = closest_points(sites, points); }, trial.threads};
  const Contender peer{[&] { reference = closest_points(sites, points, by_reference); }, trial.threads};
  cpu.work();
  peer.work();
  bool verified = true;
  const double tolerance = 1e-6 * diagonal(bounds(mesh));
  for (std::size_t i = 0; i < points.size(); ++i)
    verified &= std::abs(ours[i].distance - reference[i].distance) <= tolerance;
  if (!verified) return {};
  const Race times = race(cpu, peer, trial.repetitions);
  const auto count = static_cast<double>(points.size());
  return {.verified = true,
          .rows = {{"",
                    {{"ratio", times.ratio},
                     {"spread", times.spread},
                     {"point_us", 1e3 * times.ours_ms / count},
                     {"reference_us", 1e3 * times.peer_ms / count}}}},
          .counts = {{"triangles", static_cast<double>(mesh.triangles.size())}, {"points", count}}};
}

Mesh large_head() {
  return refine_mesh(load("head.off"), 6, 0.1);
}

std::vector<Case> cases() {
  constexpr std::size_t kMany = 100'000;
  std::vector<Case> result;
  for (const PointSet& d : point_sets())
    result.push_back({.name = d.name,
                      .description = std::string(d.description) + "; an armadillo of 52k triangles",
                      .run =
                          [=](const Trial& trial) {
                            const Mesh mesh = load("armadillo.off", "fit");
                            return scattered(trial, mesh, d.points(mesh, kMany));
                          },
                      .repetitions = 5});
  for (const std::size_t count : {1u, 16u, 1000u, 20'000u, 100'000u, 500'000u})
    result.push_back({.name = "points-" + std::to_string(count),
                      .description = std::to_string(count) + " points around a head of 105k triangles",
                      .run =
                          [=](const Trial& trial) {
                            const Mesh mesh = large_head();
                            return scattered(trial, mesh, points_around_box(mesh, count));
                          },
                      .repetitions = 5});
  return result;
}

}  // namespace

Program program() {
  return {.name = "scattered_points",
          .description = "Closest points of scattered points, against the reference engine",
          .repetition = "repetitions",
          .cases = cases()};
}

}  // namespace sdm::bench
