// Ambient occlusion in frames of two deforming bodies, against Embree: both update their trees of O2, then
// trace the same rays from the samples of O1. A repetition is a frame, every tenth of the scene. In every
// frame the answers are compared; where Embree's, in single precision, differ, all faces are tested exactly.
//
//   build/dev/bench/rays [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <sdm/sdm.h>
#include "scenes/scene.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "core/stopwatch.h"
#include "embree_rays.h"
#include "geometry/line_triangle.h"
#include "harness.h"
#include "rays/hemisphere_rays.h"
#include "timing.h"

namespace sdm::bench {
namespace {

constexpr std::uint32_t kRays = 16, kResolution = 256;
constexpr int kFrameStep = 10;

/// The rays of a sample, as ambient_occlusion() makes them.
void make_rays(const Surface& surface, std::span<const Vec3> points, std::size_t sample, double t_min,
               double t_max, std::span<Ray> rays) {
  const std::uint32_t texel = surface.sample_texels()[sample];
  const auto& [a, b, c] = surface.mesh().triangles[surface.map_faces()[texel]];
  const std::vector<Vec3>& p = surface.mesh().positions;
  std::array<Vec3, kRays> directions;
  rays::cosine_hemisphere(normalized(cross(p[b] - p[a], p[c] - p[a])), 0, texel, directions);
  for (std::size_t i = 0; i < kRays; ++i) rays[i] = {points[sample], directions[i], t_min, t_max};
}

/// Ambient occlusion by Embree. `free`: free_distances() or empty, for rays that start at 0.
void embree_occlusion(const EmbreeOccluder& embree, const Surface& surface, double max_distance,
                      std::span<const double> free, std::vector<float>& result) {
  const std::vector<Vec3> points = surface.sample_points();
  result.resize(surface.texel_faces().size());
  parallel_for(points.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::array<Ray, kRays> rays;
    std::array<std::uint8_t, kRays> met;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t texel = surface.sample_texels()[i];
      if (texel >= surface.texel_faces().size()) continue;  // ambient occlusion is that of texels
      const double from = free.empty() ? 0 : free[texel];
      result[texel] = 1;
      if (from > max_distance) continue;
      make_rays(surface, points, i, from, max_distance, rays);
      embree.occluded(rays, met.data());
      result[texel] = static_cast<float>(1 - static_cast<double>(std::ranges::count(met, 1)) / kRays);
    }
  });
}

bool meets(const Mesh& mesh, const Ray& ray) {
  return std::ranges::any_of(mesh.triangles, [&](const Triangle& t) {
    const auto hit = line_meets_triangle(ray.origin, ray.direction,
                                         {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
    return hit && hit->last >= ray.t_min && hit->first <= ray.t_max;
  });
}

/// Whether the answer for every ray agrees with Embree's or else with an exact test of all faces, and our
/// ambient occlusion with these answers. Adds the number of rays that differ from Embree's.
bool agree(const Surface& surface, const Sites& sites, const EmbreeOccluder& embree, double max_distance,
           const std::vector<float>& ours, std::size_t& differing) {
  const std::vector<Vec3> points = surface.sample_points();
  std::array<Ray, kRays> rays;
  std::array<std::uint8_t, kRays> peer;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t texel = surface.sample_texels()[i];
    if (texel >= ours.size()) continue;
    make_rays(surface, points, i, 0, max_distance, rays);
    embree.occluded(rays, peer.data());
    const std::vector<std::uint8_t> met = occluded(sites, rays);
    for (std::size_t k = 0; k < kRays; ++k) {
      if (met[k] == peer[k]) continue;
      ++differing;
      wrong += meets(sites.mesh(), rays[k]) != (met[k] != 0);
    }
    wrong += ours[texel] != static_cast<float>(1 - static_cast<double>(std::ranges::count(met, 1)) / kRays);
  }
  if (wrong > 0) std::fprintf(stderr, "%zu rays or samples are wrong\n", wrong);
  return wrong == 0;
}

/// One body on which ambient occlusion is computed, and the other.
struct Side {
  Surface surface;
  Sites sites;
  EmbreeOccluder embree;
  DistanceMap map{};
  std::vector<double> free{};
  std::vector<float> ours{}, by_embree{}, by_both{};

  Side(const Mesh& o1, const Mesh& o2) : surface(o1, {.resolution = kResolution}), sites(o2), embree(o2) {}
};

Outcome measure(const Trial& trial, scenes::SceneKind kind, double max_distance) {
  const ThreadLimit limit(trial.threads);
  scenes::Scene scene(kind);
  const Mesh first = scene.bodies()[0].mesh, second = scene.bodies()[1].mesh;
  std::array<Side, 2> sides{Side(first, second), Side(second, first)};
  std::map<std::string, std::vector<double>> times;
  std::size_t differing = 0, samples = 0;
  bool verified = true;
  const auto frame = [&](bool reversed) {
    std::map<std::string, double> spent;
    for (std::size_t b = 0; b < 2; ++b) {
      Side& side = sides[b];
      const std::vector<Vec3>& to = scene.bodies()[1 - b].mesh.positions;
      side.surface.refit(scene.bodies()[b].mesh.positions);
      const auto timed = [&](const char* what, const auto& work) {
        Stopwatch watch;
        work();
        spent[what] += watch.lap();
      };
      const std::array<std::function<void()>, 2> turns{
          [&] {
            timed("our update", [&] { side.sites.refit(to); });
            timed("map",
                  [&] { compute_map(side.surface, side.sites, {.sign = SignMethod::none}, side.map); });
            timed("our rays", [&] {
              side.ours = ambient_occlusion(side.surface, side.sites, side.map,
                                            {.rays = kRays, .max_distance = max_distance});
            });
          },
          [&] {
            timed("Embree's update", [&] { side.embree.update(to); });
            timed("Embree's rays",
                  [&] { embree_occlusion(side.embree, side.surface, max_distance, {}, side.by_embree); });
          }};
      for (const std::size_t turn : {reversed, !reversed}) turns[turn]();
      side.free = free_distances(side.surface, side.sites, side.map);
      timed("Embree's rays from the map",
            [&] { embree_occlusion(side.embree, side.surface, max_distance, side.free, side.by_both); });
      samples += side.surface.sample_texels().size();
      verified &= agree(side.surface, side.sites, side.embree, max_distance, side.ours, differing);
    }
    for (const auto& [what, ms] : spent) times[what].push_back(ms);
  };
  frame(false);  // performs all allocations
  times.clear();
  differing = samples = 0;
  for (int i = 0; i < trial.repetitions; ++i) {
    for (int step = 0; step < kFrameStep; ++step) scene.advance();
    frame(i % 2 != 0);
  }

  const auto sum = [&](std::initializer_list<const char*> parts) {
    std::vector<double> total(static_cast<std::size_t>(trial.repetitions));
    for (const char* part : parts) std::ranges::transform(total, times[part], total.begin(), std::plus());
    return total;
  };
  const auto compare = [&](std::string name, const std::vector<double>& ours,
                           const std::vector<double>& peer) {
    std::vector<double> ratios(ours.size());
    std::ranges::transform(peer, ours, ratios.begin(), std::divides());
    return Row{std::move(name),
               {{"ratio", median(ratios)},
                {"lowest", quantile(ratios, 0)},
                {"highest", quantile(ratios, 1)},
                {"ours_ms", median(ours)},
                {"peer_ms", median(peer)}}};
  };
  const std::vector<double> ours = sum({"our update", "our rays"}),
                            with_map = sum({"our update", "map", "our rays"}),
                            peer = sum({"Embree's update", "Embree's rays"});
  const double rays = kRays * static_cast<double>(samples);
  return {
      .verified = verified,
      .rows = {compare("update", times["our update"], times["Embree's update"]),
               compare("rays", times["our rays"], times["Embree's rays"]),
               compare("rays, Embree's from the map", times["our rays"], times["Embree's rays from the map"]),
               compare("update + rays", ours, peer), compare("update + map + rays", with_map, peer)},
      .counts = {{"rays_per_frame", rays / trial.repetitions},
                 {"differing_rays", static_cast<double>(differing)},
                 {"map_ms", median(times["map"])}}};
}

std::vector<Case> cases() {
  std::vector<Case> result;
  const auto add = [&](std::string name, scenes::SceneKind kind, double max_distance,
                       const std::string& what) {
    result.push_back({.name = std::move(name),
                      .description = what + ", 256², 16 rays a sample: Embree / ours",
                      .run = [=](const Trial& trial) { return measure(trial, kind, max_distance); },
                      .repetitions = 15});
  };
  add("letters", scenes::SceneKind::letters, kInfinity, "two letters, 1 high");
  add("letters-near", scenes::SceneKind::letters, 0.1, "two letters, occlusion up to 0.1");
  add("bunnies", scenes::SceneKind::bunnies, kInfinity, "two bunnies");
  add("bunnies-near", scenes::SceneKind::bunnies, 0.1, "two bunnies, occlusion up to 0.1");
  return result;
}

}  // namespace

Program program() {
  return {.name = "rays",
          .description = "Ambient occlusion of deforming bodies against Embree's rays",
          .repetition = "frames",
          .cases = cases()};
}

}  // namespace sdm::bench
