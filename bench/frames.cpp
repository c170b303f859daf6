// The time of a frame of two bodies that deform, as a simulation has it: new positions, the maps of both
// directions, and all proximity queries. The scenes are those of `sdm scene`. Exits with 1 if in some frame
// the queries and the whole maps disagree.
//
//   build/dev/bench/frames [SCENE...] [--frames N] [--resolution N] [--exact] [--json FILE]
#include <sdm/error.h>
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "core/stopwatch.h"
#include "core/vec.h"
#include "scenes/scene.h"

namespace sdm::bench {
namespace {

struct Options {
  std::vector<std::string> scenes{"letters", "bunnies"};
  std::size_t frames = 150;
  ProximityOptions query{.atlas = {.resolution = 512}};
  std::string json_file;
};

/// The frames of a scene with two bodies: of each body, its positions in each frame.
struct Motion {
  std::array<Mesh, 2> first;
  std::vector<std::array<std::vector<Vec3>, 2>> frames;

  Motion(scenes::SceneKind kind, std::size_t count) {
    scenes::Scene scene(kind);
    for (int b = 0; b < 2; ++b) first[b] = scene.bodies()[b].mesh;
    for (std::size_t i = 0; i < count; ++i) {
      frames.push_back({scene.bodies()[0].mesh.positions, scene.bodies()[1].mesh.positions});
      scene.advance();
    }
  }
};

/// Milliseconds of each frame.
struct Times {
  std::vector<double> update, queries, maps;
  std::size_t colliding = 0;     ///< frames
  std::size_t samples_used = 0;  ///< of queries, over all frames
  std::size_t wrong = 0;         ///< frames
};

/// Whether the results from the culled samples equal those from all samples.
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
  const bool exact = separation.kind == Certainty::exact;
  return (exact ? separation.value <= least + tolerance : std::abs(separation.value - least) <= tolerance) &&
         std::abs(depth.value - deepest) <= tolerance;
}

Times measure(const Motion& motion, const ProximityOptions& options) {
  ProximityQuery query(motion.first[0], motion.first[1], options);
  std::array<DistanceMap, 2> maps;
  Times times;
  const auto frame = [&](const std::array<std::vector<Vec3>, 2>& positions) {
    Stopwatch watch;
    query.update(positions[0], positions[1]);
    times.update.push_back(watch.lap());
    (void)query.separation(), (void)query.penetration_depth(), (void)query.contacts();
    times.colliding += query.colliding().value;
    times.queries.push_back(watch.lap());
    for (int b = 0; b < 2; ++b) compute_map(query.surface(b), query.sites(1 - b), {}, maps[b]);
    times.maps.push_back(watch.lap());
    times.samples_used += query.samples_used();
    times.wrong += !agree(query, maps);
  };
  frame(motion.frames.front());  // one-time initialisation
  times = {};
  for (const auto& positions : motion.frames) frame(positions);
  return times;
}

std::vector<double> sum(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> sums(a.size());
  std::ranges::transform(a, b, sums.begin(), std::plus());
  return sums;
}

nlohmann::ordered_json to_json(std::vector<double> times) {
  std::ranges::sort(times);
  const auto last = static_cast<double>(times.size() - 1);
  const auto at = [&](double share) { return times[static_cast<std::size_t>(share * last)]; };
  return {{"mean", std::reduce(times.begin(), times.end()) / static_cast<double>(times.size())},
          {"median", at(0.5)},
          {"p99", at(0.99)}};
}

nlohmann::ordered_json to_json(const Times& times) {
  const std::vector<double> loop = sum(times.update, times.queries);
  return {{"frames", times.update.size()},
          {"verified", times.wrong == 0},
          {"colliding", times.colliding},
          {"samples_used", times.samples_used / times.update.size()},
          {"ms",
           {{"update", to_json(times.update)},
            {"queries", to_json(times.queries)},
            {"maps", to_json(times.maps)},
            {"update + queries", to_json(loop)},
            {"all", to_json(sum(loop, times.maps))}}}};
}

void print(const std::string& scene, const nlohmann::ordered_json& result) {
  std::printf("%s: %d frames, %d of them colliding, %d samples used in a frame\n", scene.c_str(),
              result["frames"].get<int>(), result["colliding"].get<int>(), result["samples_used"].get<int>());
  for (const auto& [step, ms] : result["ms"].items())
    std::printf("  %-18s mean %6.2f ms   median %6.2f   99th percentile %6.2f\n", step.c_str(),
                ms["mean"].get<double>(), ms["median"].get<double>(), ms["p99"].get<double>());
}

int run(int argc, char** argv) {
  static const std::map<std::string, scenes::SceneKind> kinds{{"letters", scenes::SceneKind::letters},
                                                              {"bunnies", scenes::SceneKind::bunnies},
                                                              {"figure", scenes::SceneKind::figure}};
  Options options;
  CLI::App app{"The time of a frame: update, all queries, the maps of both directions; all cores"};
  app.add_option("SCENE", options.scenes, "letters, bunnies, figure; by default the first two")
      ->check(CLI::IsMember(kinds));
  app.add_option("--frames", options.frames, "Of each scene")
      ->check(CLI::Range(2, 100000))
      ->capture_default_str();
  app.add_option("--resolution", options.query.atlas.resolution, "Of the maps")
      ->check(CLI::Range(64, 8192))
      ->capture_default_str();
  app.add_flag("--exact", options.query.exact, "Separation and collision from the triangles");
  app.add_option("--json", options.json_file, "Write the results to this file");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  nlohmann::ordered_json json;
  std::size_t wrong = 0;
  for (const std::string& scene : options.scenes) {
    const Times times = measure(Motion(kinds.at(scene), options.frames), options.query);
    json[scene] = to_json(times);
    print(scene, json[scene]);
    if (times.wrong > 0) std::fprintf(stderr, "%s: wrong in %zu frames\n", scene.c_str(), times.wrong);
    wrong += times.wrong;
  }
  if (options.json_file.empty()) return wrong == 0 ? 0 : 1;
  std::ofstream file(options.json_file);
  if (!(file << json.dump(2) << std::endl)) throw Error("cannot write " + options.json_file);
  return wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace sdm::bench

int main(int argc, char** argv) try {
  return sdm::bench::run(argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
