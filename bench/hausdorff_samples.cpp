// Times one-sided Hausdorff distances, and writes the meshes for other libraries, for bench/peers.
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <random>
#include <vector>

#include "arrays.h"
#include "core/stopwatch.h"
#include "scenes.h"
#include "timing.h"

int main(int argc, char** argv) try {
  using namespace sdm;
  CLI::App app(
      "Computes the Hausdorff distance from O1 to O2 with one thread, for each precision, and prints a line "
      "with the lower and upper bound and the median milliseconds of building the sites of O2 and of the "
      "search. Writes arrays without headers into OUT: vertices1, vertices2 (float64), triangles1, "
      "triangles2 "
      "(int32).");
  std::string o1, o1_steps, o2, o2_steps;
  double noise = 0;
  std::filesystem::path out;
  std::vector<double> precisions;
  app.add_option("O1", o1, "A mesh of the benchmarks")->required();
  app.add_option("O1_STEPS", o1_steps, "Its transform")->required();
  app.add_option("O2", o2, "A mesh of the benchmarks")->required();
  app.add_option("O2_STEPS", o2_steps, "Its transform")->required();
  app.add_option("NOISE", noise, "Standard deviation of the noise added to each coordinate of O1")
      ->required();
  app.add_option("OUT", out)->required();
  app.add_option("PRECISION", precisions)->required();
  CLI11_PARSE(app, argc, argv);

  const ThreadLimit alone(1);
  Mesh m1 = bench::load(o1, o1_steps);
  const Mesh m2 = bench::load(o2, o2_steps);
  if (noise > 0) {
    std::mt19937 random(1);
    std::normal_distribution<double> offset(0, noise);
    for (Vec3& p : m1.positions)
      for (double& x : p) x += offset(random);
  }
  bench::write_array<Vec3>(out / "vertices1", m1.positions);
  bench::write_array<Triangle>(out / "triangles1", m1.triangles);
  bench::write_array<Vec3>(out / "vertices2", m2.positions);
  bench::write_array<Triangle>(out / "triangles2", m2.triangles);
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
    std::printf("%.17g %.17g %.6g %.6g\n", distance.lower, distance.upper, bench::median(build_ms),
                bench::median(search_ms));
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "hausdorff_samples: %s\n", error.what());
  return 1;
}
