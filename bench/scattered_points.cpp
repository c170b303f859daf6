// closest_points() for few and for many points scattered in space, against the reference engine: a scalar
// best-first search for each point. All distances are compared.
//
//   build/dev/bench/scattered_points [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <sdm/closest_points.h>
#include <sdm/threads.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "geometry/vec.h"
#include "harness.h"
#include "refine_mesh.h"
#include "scenes.h"
#include "timing.h"

namespace sdm::bench {
namespace {

/// Uniform in 1.5 times the box of the mesh.
std::vector<Vec3> points_around(const Mesh& mesh, std::size_t count) {
  const Box box = bounds(mesh);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-0.25, 1.25);
  std::vector<Vec3> points(count);
  for (Vec3& p : points)
    for (int k = 0; k < 3; ++k) p[k] = box.lo[k] + uniform(random) * (box.hi[k] - box.lo[k]);
  return points;
}

Outcome scattered(const Trial& trial, std::size_t count) {
  const ThreadLimit limit(trial.threads);
  const Mesh mesh = refine_mesh(load("head.off"), 6, 0.1);
  const Sites sites(mesh);
  const std::vector<Vec3> points = points_around(mesh, count);
  std::vector<ClosestPoint> ours, reference;
  const MapOptions by_reference{.engine = make_engine("reference")};
  const Contender cpu{[&] { ours = closest_points(sites, points); }, trial.threads};
  const Contender peer{[&] { reference = closest_points(sites, points, by_reference); }, trial.threads};
  const Race times = race(cpu, peer, trial.repetitions);
  bool verified = true;
  const double tolerance = 1e-6 * diagonal(bounds(mesh));
  for (std::size_t i = 0; i < count; ++i)
    verified &= std::abs(ours[i].distance - reference[i].distance) <= tolerance;
  return {.verified = verified,
          .rows = {{"",
                    {{"ratio", times.ratio},
                     {"spread", times.spread},
                     {"point_us", 1e3 * times.ours_ms / static_cast<double>(count)},
                     {"reference_us", 1e3 * times.peer_ms / static_cast<double>(count)}}}},
          .counts = {{"triangles", static_cast<double>(mesh.triangles.size())}}};
}

std::vector<Case> cases() {
  std::vector<Case> result;
  for (const std::size_t count : {1u, 16u, 1000u, 20'000u, 100'000u, 500'000u})
    result.push_back({.name = "points-" + std::to_string(count),
                      .description = std::to_string(count) + " points around a head of 105k triangles",
                      .run = [=](const Trial& trial) { return scattered(trial, count); },
                      .repetitions = 5});
  return result;
}

}  // namespace
}  // namespace sdm::bench

int main(int argc, char** argv) {
  using namespace sdm::bench;
  return run_program(argc, argv,
                     {.name = "scattered_points",
                      .description = "Closest points of scattered points, against the reference engine",
                      .repetition = "repetitions",
                      .cases = cases()});
}
