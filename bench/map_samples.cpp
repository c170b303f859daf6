// Times one map, and writes its samples and distances for other libraries, for bench/peers.
#include <sdm/execution.h>
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <vector>

#include "arrays.h"
#include "scenes.h"
#include "timing.h"

int main(int argc, char** argv) try {
  CLI::App app(
      "Computes the unsigned map of O1 to O2 with one thread, and prints the number of its samples and the "
      "milliseconds it takes. Writes arrays without headers into OUT: points (float64), distances (float32), "
      "vertices (float64) and triangles (uint32) of O2.");
  std::string o1, o1_steps, o2, o2_steps;
  std::filesystem::path out;
  std::uint32_t resolution = 0;
  app.add_option("O1", o1, "A mesh of the benchmarks")->required();
  app.add_option("O1_STEPS", o1_steps, "Its transform")->required();
  app.add_option("O2", o2, "A mesh of the benchmarks, or box for a box around O1")->required();
  app.add_option("O2_STEPS", o2_steps, "Its transform")->required();
  app.add_option("RESOLUTION", resolution)->required();
  app.add_option("OUT", out)->required();
  CLI11_PARSE(app, argc, argv);
  const sdm::Surface surface(sdm::bench::load(o1, o1_steps), {.resolution = resolution});
  const sdm::Sites sites(o2 == "box" ? sdm::bench::paper_box(surface.mesh())
                                     : sdm::bench::load(o2, o2_steps));
  sdm::DistanceMap map;
  const sdm::MapOptions options{.sign = sdm::SignMethod::none};
  const sdm::bench::Contender ours{[&] { sdm::compute_map(surface, sites, options, map); }, 1};
  const double ms = sdm::bench::median(sdm::bench::take_turns(std::array{ours}, 3)[0]);

  std::vector<sdm::Vec3> points;
  std::vector<float> distances;
  for (const std::uint32_t texel : surface.sample_texels()) {
    points.push_back(surface.texel_point(texel));
    distances.push_back(map.distance[texel]);
  }
  sdm::bench::write_array<sdm::Vec3>(out / "points", points);
  sdm::bench::write_array<float>(out / "distances", distances);
  sdm::bench::write_array<sdm::Vec3>(out / "vertices", sites.mesh().positions);
  sdm::bench::write_array<sdm::Triangle>(out / "triangles", sites.mesh().triangles);
  std::cout << points.size() << ' ' << ms << '\n';
} catch (const std::exception& error) {
  std::fprintf(stderr, "map_samples: %s\n", error.what());
  return 1;
}
