// Exact separation and collision of two meshes in many poses against FCL, side by side in one run, after the
// results have been compared in every pose.
//
//   build/dev/bench/proximity [PAIR...] [--poses N] [--json FILE] [--list]
//
// Exits with 1 if a result is wrong.
#include <sdm/error.h>
#include <sdm/threads.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/stopwatch.h"
#include "core/vec.h"
#include "fcl_pair.h"
#include "measure.h"
#include "poses.h"
#include "proximity/exact/pair_search.h"
#include "scene/letters.h"
#include "scene/reduce_mesh.h"
#include "scenes.h"

namespace sdm::bench {
namespace {

struct Pair {
  std::string name, what;
  std::function<std::array<Mesh, 2>()> meshes;
};

std::vector<Pair> all_pairs() {
  const auto bunny = [] { return load("bunny.obj", "fit"); };
  const auto armadillo = [] { return load("armadillo.off", "fit"); };
  return {
      {"letters", "E and G, 2.1k and 1.6k triangles",
       [] {
         return std::array{letter_of('E', 2100), letter_of('G', 1600)};
       }},
      {"bunnies", "two bunnies of 2k",
       [=] {
         return std::array{reduce_mesh(bunny(), 2000), reduce_mesh(bunny(), 2000)};
       }},
      {"bunny-armadillo-5k", "5k each",
       [=] {
         return std::array{reduce_mesh(bunny(), 5000), reduce_mesh(armadillo(), 5000)};
       }},
      {"figure-letter", "17.2k and 2.1k",
       [] {
         return std::array{paper_figure(), letter_of('E', 2100)};
       }},
      {"figure-box", "17.2k, and a box of 12 larger than it",
       [] {
         return std::array{paper_figure(), paper_box(paper_figure())};
       }},
      {"bunny-armadillo", "70k and 52k",
       [=] {
         return std::array{bunny(), armadillo()};
       }},
  };
}

/// Microseconds in each pose.
struct Times {
  std::vector<double> ours, fcl;
};

// The least of a few turns, each long enough for the clock, that both take one after the other.
void time_both(const std::function<void()>& ours, const std::function<void()>& fcl, Times& times) {
  constexpr int kTurns = 3;
  constexpr double kLongEnough = 0.1;  // milliseconds
  const auto microseconds = [](const std::function<void()>& work) {
    Stopwatch watch;
    double elapsed = 0;
    int runs = 0;
    for (; elapsed < kLongEnough; ++runs) {
      work();
      elapsed += watch.lap();
    }
    return 1000 * elapsed / runs;
  };
  double least[2] = {microseconds(ours), microseconds(fcl)};
  for (int turn = 1; turn < kTurns; ++turn) {
    least[0] = std::min(least[0], microseconds(ours));
    least[1] = std::min(least[1], microseconds(fcl));
  }
  times.ours.push_back(least[0]);
  times.fcl.push_back(least[1]);
}

struct Outcome {
  std::size_t wrong = 0;  ///< poses
  Times separation, collision;
};

Outcome measure(const Pair& pair, std::size_t pose_count) {
  const auto [m1, m2] = pair.meshes();
  const Sites o1(m1), o2(m2);
  const FclPair fcl(m1, m2);
  const double size = diagonal(bounds(m1)) + diagonal(bounds(m2));
  std::mt19937 random(1);
  exact::PairWorkspace workspace;
  Outcome outcome;
  for (const Affine& pose : random_poses(o1, o2, pose_count, random)) {
    const exact::MeshPair posed{internals(o1), internals(o2), pose};
    const auto separate = [&] { return exact::find_closest(posed, 10 * size, workspace); };
    const auto collide = [&] { return exact::find_intersection(posed, workspace).intersecting; };
    // FCL says -1 for surfaces that intersect, and moves vertices with other roundings: of surfaces that just
    // touch it may say either.
    const Separation found = separate();
    const bool same_distance = std::abs(found.distance - std::max(0.0, fcl.distance(pose))) <= 1e-6 * size;
    const bool same_verdict = collide() == fcl.collide(pose) || found.distance < 1e-12 * size;
    outcome.wrong += !same_distance || !same_verdict || collide() != found.intersecting;
    time_both([&] { (void)separate(); }, [&] { (void)fcl.distance(pose); }, outcome.separation);
    time_both([&] { (void)collide(); }, [&] { (void)fcl.collide(pose); }, outcome.collision);
  }
  return outcome;
}

double faster_in(const Times& times) {
  std::size_t poses = 0;
  for (std::size_t i = 0; i < times.ours.size(); ++i) poses += times.ours[i] < times.fcl[i];
  return static_cast<double>(poses) / static_cast<double>(times.ours.size());
}

void print_row(const Pair& pair, const char* query, const Times& times) {
  const double ours = median(times.ours), fcl = median(times.fcl);
  std::printf("| %s | %s | %.2f | %.2f | %.1f | %.0f %% |\n", pair.name.c_str(), query, ours, fcl, fcl / ours,
              100 * faster_in(times));
  std::fflush(stdout);
}

nlohmann::ordered_json to_json(const Times& times) {
  const double ours = median(times.ours), fcl = median(times.fcl);
  return {{"ours_us", ours}, {"fcl_us", fcl}, {"ratio", fcl / ours}, {"faster_in", faster_in(times)}};
}

int run(int argc, char** argv) {
  std::vector<std::string> names;
  std::string json_file;
  std::size_t poses = 200;
  bool list = false;
  CLI::App app{"Exact separation and collision against FCL, one thread, medians over poses"};
  app.add_option("PAIR", names, "Pairs to measure; all by default");
  app.add_option("--poses", poses, "Of each pair")->check(CLI::Range(5, 100000));
  app.add_option("--json", json_file, "Write the results to this file");
  app.add_flag("--list", list, "List the pairs and measure none");
  std::vector<Pair> chosen = all_pairs();
  try {
    app.parse(argc, argv);
    for (const std::string& name : names)
      if (std::ranges::count(chosen, name, &Pair::name) == 0)
        throw CLI::ValidationError("there is no pair '" + name + "'; see --list", 2);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (!names.empty())
    std::erase_if(chosen, [&](const Pair& pair) { return std::ranges::count(names, pair.name) == 0; });

  if (list) {
    for (const Pair& pair : chosen) std::printf("%-20s %s\n", pair.name.c_str(), pair.what.c_str());
    return 0;
  }
  std::ofstream file;
  if (!json_file.empty()) file.open(json_file);
  if (!file) throw Error("cannot write " + json_file);
  const ThreadLimit alone(1);
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  std::size_t wrong = 0;
  std::puts(
      "| pair | query | ours µs | FCL µs | FCL / ours | faster in |\n| --- | --- | ---: | ---: | ---: | ---: "
      "|");
  for (const Pair& pair : chosen) {
    const Outcome outcome = measure(pair, poses);
    print_row(pair, "separation", outcome.separation);
    print_row(pair, "collision", outcome.collision);
    if (outcome.wrong > 0)
      std::fprintf(stderr, "%s: in %zu of %zu poses FCL disagrees\n", pair.name.c_str(), outcome.wrong,
                   poses);
    json[pair.name] = {{"verified", outcome.wrong == 0},
                       {"poses", poses},
                       {"separation", to_json(outcome.separation)},
                       {"collision", to_json(outcome.collision)}};
    wrong += outcome.wrong;
  }
  if (!json_file.empty() && !(file << json.dump(2) << std::endl)) throw Error("cannot write " + json_file);
  return wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace sdm::bench

int main(int argc, char** argv) try {
  return sdm::bench::run(argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "proximity: %s\n", error.what());
  return 1;
}
