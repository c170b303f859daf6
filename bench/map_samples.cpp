// Times one map, and writes its samples and distances for other libraries, for bench/peers.
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <vector>

#include "arrays.h"
#include "samples.h"
#include "scenes.h"
#include "timing.h"

namespace sdm::bench {
namespace {

struct MapSamples {
  std::string o1, o1_steps, o2, o2_steps;
  std::filesystem::path out;
  std::uint32_t resolution = 0;
};

void write_map_samples(const MapSamples& options) {
  const auto& [o1, o1_steps, o2, o2_steps, out, resolution] = options;
  const Surface surface(load(o1, o1_steps), {.resolution = resolution});
  const Sites sites(o2 == "box" ? paper_box(surface.mesh()) : load(o2, o2_steps));
  DistanceMap map;
  const MapOptions unsigned_map{.sign = SignMethod::none};
  const Contender ours{[&] { compute_map(surface, sites, unsigned_map, map); }, 1};
  const double ms = median(take_turns(std::array{ours}, 3)[0]);

  std::vector<Vec3> points;
  std::vector<float> distances;
  for (const std::uint32_t texel : surface.sample_texels()) {
    points.push_back(surface.texel_point(texel));
    distances.push_back(map.distance[texel]);
  }
  write_array<Vec3>(out / "points", points);
  write_array<float>(out / "distances", distances);
  write_array<Vec3>(out / "vertices", sites.mesh().positions);
  write_array<Triangle>(out / "triangles", sites.mesh().triangles);
  std::cout << points.size() << ' ' << ms << '\n';
}

}  // namespace

void add_map(CLI::App& program) {
  CLI::App& app = *program.add_subcommand(
      "map",
      "Computes the unsigned map of O1 to O2 with one thread, and prints the number of its samples and the "
      "milliseconds it takes. Writes arrays without headers into OUT: points (float64), distances (float32), "
      "vertices (float64) and triangles (uint32) of O2.");
  const auto options = std::make_shared<MapSamples>();
  app.add_option("O1", options->o1, "A mesh of the benchmarks")->required();
  app.add_option("O1_STEPS", options->o1_steps, "Its transform")->required();
  app.add_option("O2", options->o2, "A mesh of the benchmarks, or box for a box around O1")->required();
  app.add_option("O2_STEPS", options->o2_steps, "Its transform")->required();
  app.add_option("RESOLUTION", options->resolution)->required();
  app.add_option("OUT", options->out)->required();
  app.callback([options] { write_map_samples(*options); });
}

}  // namespace sdm::bench
