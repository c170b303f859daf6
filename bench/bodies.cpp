// Crowds of deforming bodies: all near pairs in each frame, compared with the distances of the same pairs by
// FCL's dynamic AABB tree. A repetition is a frame, whose separations are compared.
//
//   build/dev/bench/bodies [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
//
// Our frame is a refit of all bodies and pairs(): separation, collision and penetration depth. FCL's frame is
// a refit of all bodies and the separations; FCL uses one thread. The rigid bodies share ten shapes and are
// moved by poses; FCL moves all vertices of theirs.
#include <sdm/multi_body_query.h>
#include <sdm/threads.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/geometry/vec.h"
#include "core/stopwatch.h"
#include "fcl_crowd.h"
#include "harness.h"
#include "timing.h"

namespace sdm::bench {
namespace {

/// A sphere of diameter 1 with 500 triangles.
Mesh ball() {
  constexpr std::uint32_t kAround = 25, kRings = 10;
  Mesh mesh;
  const auto add = [&](double polar, double angle) {
    mesh.positions.push_back({0.5 * std::sin(polar) * std::cos(angle),
                              0.5 * std::sin(polar) * std::sin(angle), 0.5 * std::cos(polar)});
  };
  add(0, 0);
  for (std::uint32_t ring = 1; ring <= kRings; ++ring)
    for (std::uint32_t i = 0; i < kAround; ++i)
      add(std::numbers::pi * ring / (kRings + 1), 2 * std::numbers::pi * i / kAround);
  add(std::numbers::pi, 0);
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  const auto at = [](std::uint32_t ring, std::uint32_t i) { return 1 + ring * kAround + i % kAround; };
  for (std::uint32_t i = 0; i < kAround; ++i) {
    mesh.triangles.push_back({0, at(0, i), at(0, i + 1)});
    for (std::uint32_t ring = 0; ring + 1 < kRings; ++ring) {
      mesh.triangles.push_back({at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)});
      mesh.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)});
    }
    mesh.triangles.push_back({last, at(kRings - 1, i + 1), at(kRings - 1, i)});
  }
  return mesh;
}

/// Balls with travelling waves on their surfaces. They drift through a cube with a volume of 5 units per
/// body, and are reflected at its walls.
class Crowd {
 public:
  explicit Crowd(std::size_t size) : side_(std::cbrt(5.0 * static_cast<double>(size))), positions_(size) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto vector = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
    for (std::size_t i = 0; i < size; ++i)
      movers_.push_back({side_ * vector(), 0.02 * vector(), 6.0 * vector(), 3 * uniform(random)});
  }

  std::span<const std::vector<Vec3>> at(int frame) {
    for (std::size_t i = 0; i < movers_.size(); ++i) {
      const Mover& m = movers_[i];
      const Vec3 centre = reflected(m.start + static_cast<double>(frame) * m.velocity);
      positions_[i].clear();
      for (const Vec3& p : ball_.positions)
        positions_[i].push_back(centre + (1 + 0.2 * std::sin(dot(m.wave, p) + m.phase + 0.1 * frame)) * p);
    }
    return positions_;
  }
  std::vector<Mesh> meshes() {
    std::vector<Mesh> result;
    for (const std::vector<Vec3>& positions : at(0)) result.push_back({positions, ball_.triangles, {}});
    return result;
  }

 private:
  struct Mover {
    Vec3 start, velocity, wave;
    double phase;
  };
  [[nodiscard]] Vec3 reflected(Vec3 p) const {
    for (double& x : p) x = std::abs(std::remainder(x, 2 * side_));
    return p;
  }

  Mesh ball_ = ball();
  double side_;
  std::vector<Mover> movers_;
  std::vector<std::vector<Vec3>> positions_;
};

// FCL rounds moved vertices differently, and returns -1 for surfaces that intersect.
bool agree(std::span<const PairProximity> ours, std::span<const FclCrowd::Pair> fcl, double max_distance) {
  constexpr double kTolerance = 1e-6;
  auto pair = ours.begin();
  for (const FclCrowd::Pair& theirs : fcl) {
    const bool same = pair != ours.end() && pair->first == theirs.first && pair->second == theirs.second;
    if (!same && theirs.distance < max_distance - kTolerance) return false;
    if (!same) continue;
    if (std::abs(pair->separation.value - std::max(0.0, theirs.distance)) > kTolerance) return false;
    ++pair;
  }
  return pair == ours.end();
}

Outcome measure(const Trial& trial, std::size_t size, double max_distance) {
  const ThreadLimit limit(trial.threads);
  Crowd crowd(size);
  const std::vector<Mesh> meshes = crowd.meshes();
  MultiBodyQuery query(meshes, {.max_distance = max_distance});
  FclCrowd fcl(meshes);
  std::vector<double> ours_ms, fcl_ms;
  std::size_t candidates = 0, pairs = 0, colliding = 0;
  bool verified = true;
  std::vector<std::span<const Vec3>> positions(size);
  constexpr int kWarmUp = 3;
  for (int frame = -kWarmUp; frame < trial.repetitions; ++frame) {
    const std::span<const std::vector<Vec3>> moved = crowd.at(frame);
    std::ranges::copy(moved, positions.begin());
    Stopwatch watch;
    query.refit(positions);
    (void)query.pairs();
    const double our_time = watch.lap();
    fcl.refit(moved);
    const auto theirs = fcl.distances(max_distance);
    const double fcl_time = watch.lap();
    if (frame < 0) continue;
    ours_ms.push_back(our_time);
    fcl_ms.push_back(fcl_time);
    verified &= agree(query.pairs(), theirs, max_distance);
    candidates += query.candidate_pairs();
    pairs += query.pairs().size();
    for (const PairProximity& pair : query.pairs()) colliding += pair.colliding.value;
  }

  const auto per_frame = [&](std::size_t count) { return static_cast<double>(count) / trial.repetitions; };
  const auto row = [&](const char* name, const std::vector<double>& times) {
    return Row{name,
               {{"mean_ms", mean(times)},
                {"p99_ms", quantile(times, 0.99)},
                {"fcl_over_this", mean(fcl_ms) / mean(times)}}};
  };
  return {.verified = verified,
          .rows = {row("ours", ours_ms), row("fcl", fcl_ms)},
          .counts = {{"candidate_pairs", per_frame(candidates)},
                     {"pairs", per_frame(pairs)},
                     {"colliding", per_frame(colliding)}}};
}

std::vector<Case> cases() {
  std::vector<Case> result;
  for (const bool near : {true, false})
    for (const std::size_t size : {5u, 10u, 20u, 40u}) {
      const double max_distance = near ? 0.5 : std::numeric_limits<double>::infinity();
      result.push_back({.name = (near ? "near-" : "all-") + std::to_string(size),
                        .description = std::to_string(size) + " bodies of 500 triangles, " +
                                       (near ? "pairs nearer than half a body's width" : "all pairs"),
                        .run = [=](const Trial& trial) { return measure(trial, size, max_distance); },
                        .repetitions = 100,
                        .threads = 0});
    }
  return result;
}

}  // namespace
}  // namespace sdm::bench

int main(int argc, char** argv) {
  using namespace sdm::bench;
  return run_program(argc, argv,
                     {.name = "bodies",
                      .description = "Proximity of many deforming bodies against FCL on one thread",
                      .repetition = "frames",
                      .cases = cases()});
}
