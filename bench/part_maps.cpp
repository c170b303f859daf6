// Maps of one part, beside the map of the same samples to another part: the distance to itself and the
// thickness. They take turns, on one thread. Distances of some texels are first compared with those to all
// faces.
//
//   build/dev/bench/part_maps [--list] [--filter REGEX] [--repetitions N] [--json FILE]
#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/measure.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "geometry/point_triangle.h"
#include "geometry/triangle.h"
#include "harness.h"
#include "scenes.h"
#include "timing.h"

namespace sdm::bench {
namespace {

struct Part {
  std::string name, file, other;
};
const Part kParts[] = {{"armadillo", "armadillo.off", "bunny.obj"}, {"bunny", "bunny.obj", "armadillo.off"}};

bool verify(const Surface& surface, const DistanceMap& map, const Exclusion& exclusion) {
  const Mesh& mesh = surface.mesh();
  const std::span<const std::uint32_t> texels = surface.sample_texels();
  for (std::size_t i = 0; i < texels.size(); i += 1 + texels.size() / 100) {
    const Vec3 p = surface.texel_point(texels[i]);
    double squared = std::numeric_limits<double>::infinity();
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
      if (!exclusion.excludes(surface.map_faces()[texels[i]], f))
        squared = std::min(squared, squared_norm(closest_on_triangle(p, corners_of(mesh, f)) - p));
    if (!(std::abs(map.distance[texels[i]] - std::sqrt(squared)) < 1e-6)) return false;
  }
  return true;
}

Outcome run(const Trial& trial, const Part& part) {
  const ThreadLimit limit(trial.threads);
  const Mesh mesh = load(part.file, "fit");
  const Surface surface(mesh, {.resolution = 512});
  const Sites own(mesh), other(load(part.other, "fit,translate:0.1:0:0"));
  const Exclusion rings(mesh), geodesic(mesh, {.rule = {.geodesic = 0.1}});
  const SelfOptions by_rings{.exclusion = rings}, by_length{.exclusion = geodesic};

  struct Measured {
    std::string name;
    std::function<void()> work;
  };
  const auto map_of = [&](const Measure& measure) {
    return [&surface, &own, measure] { (void)compute_map(surface, own, measure); };
  };
  const std::vector<Measured> measured{
      {"pair", [&] { (void)compute_map(surface, other, {.sign = SignMethod::none}); }},
      {"self, 1 ring", map_of(by_rings)},
      {"self, geodesic 0.1", map_of(by_length)},
      {"self, 1 ring, vertices", [&] { (void)distances_at_vertices(mesh, own, by_rings); }},
      {"thickness, ball", map_of(ThicknessOptions{})},
      {"thickness, ray", map_of(ThicknessOptions{.method = ThicknessMethod::ray})}};
  std::vector<Contender> contenders;
  for (const Measured& m : measured) contenders.push_back({m.work, trial.threads});

  Outcome outcome{.verified = verify(surface, compute_map(surface, own, by_rings), rings) &&
                              verify(surface, compute_map(surface, own, by_length), geodesic)};
  const std::vector<std::vector<double>> times = take_turns(contenders, trial.repetitions, 0);
  for (std::size_t i = 0; i < measured.size(); ++i)
    outcome.rows.push_back(
        {measured[i].name, {{"ms", median(times[i])}, {"ratio", median(times[i]) / median(times[0])}}});
  return outcome;
}

std::vector<Case> cases() {
  std::vector<Case> result;
  for (const Part& part : kParts)
    result.push_back({.name = part.name,
                      .description = "maps of 512² of the " + part.name,
                      .run = [&part](const Trial& trial) { return run(trial, part); },
                      .repetitions = 7});
  return result;
}

}  // namespace

Program program() {
  return {.name = "part_maps",
          .description = "Maps of one part, beside one to another part",
          .repetition = "repetitions",
          .cases = cases()};
}

}  // namespace sdm::bench
