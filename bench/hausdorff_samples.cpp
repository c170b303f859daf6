// Times one-sided Hausdorff distances, and writes the meshes for other libraries, for bench/peers.
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <random>
#include <vector>

#include "arrays.h"
#include "core/stopwatch.h"
#include "samples.h"
#include "scenes.h"
#include "timing.h"

namespace sdm::bench {
namespace {

struct HausdorffSamples {
  std::string o1, o1_steps, o2, o2_steps;
  double noise = 0;
  std::filesystem::path out;
  std::vector<double> precisions;
};

void write_hausdorff_samples(const HausdorffSamples& options) {
  const auto& [o1, o1_steps, o2, o2_steps, noise, out, precisions] = options;

  const ThreadLimit alone(1);
  Mesh m1 = load(o1, o1_steps);
  const Mesh m2 = load(o2, o2_steps);
  if (noise > 0) {
    std::mt19937 random(1);
    std::normal_distribution<double> offset(0, noise);
    for (Vec3& p : m1.positions)
      for (double& x : p) x += offset(random);
  }
  write_array<Vec3>(out / "vertices1", m1.positions);
  write_array<Triangle>(out / "triangles1", m1.triangles);
  write_array<Vec3>(out / "vertices2", m2.positions);
  write_array<Triangle>(out / "triangles2", m2.triangles);
  constexpr int kTurns = 3;
  for (const double precision : precisions) {
    std::vector<double> build_ms, search_ms;
    BoundedLength distance;
    for (int turn = 0; turn < kTurns; ++turn) {
      Mesh copy = m2;
      Stopwatch watch;
      const Sites sites(std::move(copy));
      build_ms.push_back(watch.lap());
      distance = one_sided_hausdorff(m1, sites, {.precision = precision}).distance;
      search_ms.push_back(watch.lap());
    }
    std::printf("%.17g %.17g %.6g %.6g\n", distance.lower, distance.upper, median(build_ms),
                median(search_ms));
  }
}

}  // namespace

void add_hausdorff(CLI::App& program) {
  CLI::App& app = *program.add_subcommand(
      "hausdorff",
      "Computes the Hausdorff distance from O1 to O2 with one thread, for each precision, and prints a line "
      "with the lower and upper bound and the median milliseconds of building the sites of O2 and of the "
      "search. Writes arrays without headers into OUT: vertices1, vertices2 (float64), triangles1, "
      "triangles2 (int32).");
  const auto options = std::make_shared<HausdorffSamples>();
  app.add_option("O1", options->o1, "A mesh of the benchmarks")->required();
  app.add_option("O1_STEPS", options->o1_steps, "Its transform")->required();
  app.add_option("O2", options->o2, "A mesh of the benchmarks")->required();
  app.add_option("O2_STEPS", options->o2_steps, "Its transform")->required();
  app.add_option("NOISE", options->noise, "Standard deviation of the noise added to each coordinate of O1")
      ->required();
  app.add_option("OUT", options->out)->required();
  app.add_option("PRECISION", options->precisions)->required();
  app.callback([options] { write_hausdorff_samples(*options); });
}

}  // namespace sdm::bench
