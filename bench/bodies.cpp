// Crowds of deforming bodies: all near pairs in each frame, against FCL's dynamic tree of boxes with
// distances of the same pairs, side by side in one run; separations are compared in every frame.
//
//   build/dev/bench/bodies [--bodies N...] [--frames N] [--threads N] [--json FILE]
//
// A frame of ours is an update of all bodies and pairs(): separation with bounds, collision and penetration
// depth, from samples or exactly. A frame of FCL's is a refit of all and the separations, on one thread.
// Exits with 1 if a result is wrong.
#include <sdm/multi_body_query.h>
#include <sdm/error.h>
#include <sdm/threads.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "core/stopwatch.h"
#include "core/vec.h"
#include "fcl_crowd.h"
#include "measure.h"

namespace sdm::bench {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

/// A sphere of diameter 1, of 500 triangles.
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

/// Balls with waves on them, which drift through a cube that holds one body for each 5 units of volume, and
/// are reflected by its walls.
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

struct Outcome {
  std::size_t wrong = 0;                                 ///< frames
  std::size_t candidates = 0, pairs = 0, colliding = 0;  ///< of all frames
  std::vector<double> sampled, exact, fcl;               ///< milliseconds of each frame

  [[nodiscard]] double per_frame(std::size_t count) const {
    return static_cast<double>(count) / static_cast<double>(exact.size());
  }
};

// FCL moves through other roundings, and says -1 of surfaces that intersect.
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

Outcome measure(std::size_t size, double max_distance, int frames) {
  Crowd crowd(size);
  const std::vector<Mesh> meshes = crowd.meshes();
  MultiBodyQuery sampled(meshes, {.max_distance = max_distance});
  MultiBodyQuery exact(meshes, {.exact = true, .max_distance = max_distance});
  FclCrowd fcl(meshes);
  Outcome outcome;
  std::vector<std::span<const Vec3>> positions(size);
  constexpr int kWarmUp = 3;
  for (int frame = -kWarmUp; frame < frames; ++frame) {
    const std::span<const std::vector<Vec3>> moved = crowd.at(frame);
    std::ranges::copy(moved, positions.begin());
    Stopwatch watch;
    sampled.update(positions);
    (void)sampled.pairs();
    const double sampled_ms = watch.lap();
    exact.update(positions);
    (void)exact.pairs();
    const double exact_ms = watch.lap();
    fcl.update(moved);
    const auto theirs = fcl.distances(max_distance);
    const double fcl_ms = watch.lap();
    if (frame < 0) continue;
    outcome.sampled.push_back(sampled_ms);
    outcome.exact.push_back(exact_ms);
    outcome.fcl.push_back(fcl_ms);
    outcome.wrong += !agree(exact.pairs(), theirs, max_distance);
    outcome.candidates += exact.candidate_pairs();
    outcome.pairs += exact.pairs().size();
    for (const PairProximity& pair : exact.pairs()) outcome.colliding += pair.colliding.value;
  }
  return outcome;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

void print_row(std::size_t size, double max_distance, const Outcome& o) {
  std::printf("| %zu | %g | %.1f | %.1f | %.1f |", size, max_distance, o.per_frame(o.candidates),
              o.per_frame(o.pairs), o.per_frame(o.colliding));
  for (const std::vector<double>* times : {&o.sampled, &o.exact, &o.fcl})
    std::printf(" %.2f | %.2f |", mean(*times), quantile(*times, 0.99));
  std::printf(" %.1f |\n", mean(o.fcl) / mean(o.exact));
  std::fflush(stdout);
}

nlohmann::ordered_json to_json(const std::vector<double>& times) {
  return {{"mean_ms", mean(times)}, {"p99_ms", quantile(times, 0.99)}};
}

nlohmann::ordered_json to_json(std::size_t size, double max_distance, int frames, const Outcome& o) {
  return {{"bodies", size},
          {"max_distance", max_distance},  // null: all pairs
          {"frames", frames},
          {"threads", thread_count()},
          {"verified", o.wrong == 0},
          {"candidate_pairs", o.per_frame(o.candidates)},
          {"pairs", o.per_frame(o.pairs)},
          {"colliding", o.per_frame(o.colliding)},
          {"sampled", to_json(o.sampled)},
          {"exact", to_json(o.exact)},
          {"fcl", to_json(o.fcl)}};
}

int run(int argc, char** argv) {
  std::vector<std::size_t> sizes{5, 10, 20, 40};
  int frames = 100;
  unsigned threads = 0;
  std::string json_file;
  CLI::App app{"Frames of many bodies of 500 triangles, near pairs and all pairs, against FCL on one thread"};
  app.add_option("--bodies", sizes, "How many; several sizes")->check(CLI::Range(1, 1000));
  app.add_option("--frames", frames, "Of each size")->check(CLI::Range(2, 100000));
  app.add_option("--threads", threads, "That ours may use, 0 for all cores");
  app.add_option("--json", json_file, "Write the results to this file");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  std::ofstream file;
  if (!json_file.empty()) file.open(json_file);
  if (!file) throw Error("cannot write " + json_file);
  const ThreadLimit limit(threads);
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  bool good = true;
  std::printf(
      "Milliseconds a frame, mean and 99th percentile; ours on %u threads.\n\n"
      "| bodies | max distance | candidates | pairs | colliding | sampled | p99 | exact | p99 | FCL | p99 | "
      "FCL / exact |\n|%s\n",
      thread_count(), " ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
  for (const double max_distance : {0.5, kAny})
    for (const std::size_t size : sizes) {
      const Outcome outcome = measure(size, max_distance, frames);
      print_row(size, max_distance, outcome);
      if (outcome.wrong > 0)
        std::fprintf(stderr, "%zu bodies: in %zu of %d frames FCL disagrees\n", size, outcome.wrong, frames);
      json.push_back(to_json(size, max_distance, frames, outcome));
      good = good && outcome.wrong == 0;
    }
  if (!json_file.empty() && !(file << json.dump(2) << std::endl)) throw Error("cannot write " + json_file);
  return good ? 0 : 1;
}

}  // namespace
}  // namespace sdm::bench

int main(int argc, char** argv) try {
  return sdm::bench::run(argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "bodies: %s\n", error.what());
  return 1;
}
