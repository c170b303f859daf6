// closest_points() for points of several distributions, and for few and many of them, against the reference
// engine: a scalar best-first search for each point. All distances are compared first.
//
//   build/dev/bench/scattered_points [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <sdm/closest_points.h>
#include <sdm/surface.h>
#include <sdm/threads.h>

#include <cmath>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "geometry/triangle.h"
#include "geometry/vec.h"
#include "harness.h"
#include "refine_mesh.h"
#include "scenes.h"
#include "timing.h"

namespace sdm::bench {
namespace {

/// Points about a mesh whose longest side is 1, in no order unless stated.
using Points = std::vector<Vec3> (*)(const Mesh& mesh, std::size_t count);

/// Uniform in a box `factor` times as large as that of the mesh, about its centre.
std::vector<Vec3> uniform(const Mesh& mesh, std::size_t count, double factor) {
  const Box box = bounds(mesh);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0.5 - factor / 2, 0.5 + factor / 2);
  std::vector<Vec3> points(count);
  for (Vec3& p : points)
    for (int k = 0; k < 3; ++k) p[k] = box.lo[k] + part(random) * (box.hi[k] - box.lo[k]);
  return points;
}
std::vector<Vec3> in_box(const Mesh& mesh, std::size_t count) {
  return uniform(mesh, count, 1);
}
std::vector<Vec3> around_box(const Mesh& mesh, std::size_t count) {
  return uniform(mesh, count, 1.5);
}

/// Uniform in [−5, 5]³ about its centre.
std::vector<Vec3> far_away(const Mesh& mesh, std::size_t count) {
  const Box box = bounds(mesh);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-5, 5);
  std::vector<Vec3> points(count);
  for (Vec3& p : points)
    p = 0.5 * (box.lo + box.hi) + Vec3{coordinate(random), coordinate(random), coordinate(random)};
  return points;
}

/// The nodes of a grid that fills the box, row by row; about `count` of them.
std::vector<Vec3> grid(const Mesh& mesh, std::size_t count) {
  const Box box = bounds(mesh);
  const auto side = static_cast<std::size_t>(std::cbrt(static_cast<double>(count)));
  std::vector<Vec3> points;
  for (std::size_t z = 0; z < side; ++z)
    for (std::size_t y = 0; y < side; ++y)
      for (std::size_t x = 0; x < side; ++x) {
        Vec3& p = points.emplace_back();
        const std::size_t index[3] = {x, y, z};
        for (int k = 0; k < 3; ++k)
          p[k] =
              std::lerp(box.lo[k], box.hi[k], static_cast<double>(index[k]) / static_cast<double>(side - 1));
      }
  return points;
}

/// Uniform on the surface, and moved by a normal distribution of this deviation.
std::vector<Vec3> near_surface(const Mesh& mesh, std::size_t count, double deviation) {
  std::mt19937 random(7);
  std::vector<double> area;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto [a, b, c] = corners_of(mesh, f);
    area.push_back(norm(cross(b - a, c - a)));
  }
  std::discrete_distribution<std::size_t> face(area.begin(), area.end());
  std::uniform_real_distribution<double> part(0, 1);
  std::normal_distribution<double> offset(0, deviation);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    const auto [a, b, c] = corners_of(mesh, face(random));
    const double root = std::sqrt(part(random)), along = part(random);
    p = (1 - root) * a + root * (1 - along) * b + root * along * c;
    for (int k = 0; k < 3; ++k) p[k] += offset(random);
  }
  return points;
}
std::vector<Vec3> near_1e2(const Mesh& mesh, std::size_t count) {
  return near_surface(mesh, count, 1e-2);
}
std::vector<Vec3> near_1e3(const Mesh& mesh, std::size_t count) {
  return near_surface(mesh, count, 1e-3);
}

/// The samples of a map from another mesh that penetrates this one, in the order of the map.
std::vector<Vec3> samples_of_map(std::uint32_t resolution) {
  const Surface surface(load("bunny.obj", "fit,translate:-0.1:0:0"), {.resolution = resolution});
  std::vector<Vec3> points;
  for (const std::uint32_t texel : surface.sample_texels()) points.push_back(surface.texel_point(texel));
  return points;
}
std::vector<Vec3> map_512(const Mesh&, std::size_t) {
  return samples_of_map(512);
}
std::vector<Vec3> map_1024(const Mesh&, std::size_t) {
  return samples_of_map(1024);
}

struct Distribution {
  const char *name, *description;
  Points points;
};
constexpr Distribution kDistributions[] = {
    {"far", "uniform in [-5, 5]^3", far_away},
    {"box-1.5", "uniform in 1.5 times the box", around_box},
    {"box", "uniform in the box", in_box},
    {"grid", "a grid in the box", grid},
    {"near-1e-2", "near the surface, sigma 1e-2", near_1e2},
    {"near-1e-3", "near the surface, sigma 1e-3", near_1e3},
    {"map-512", "samples of a map of 512^2, penetrating, in its order", map_512},
    {"map-1024", "samples of a map of 1024^2, penetrating, in its order", map_1024},
};

Outcome scattered(const Trial& trial, const Mesh& mesh, std::span<const Vec3> points) {
  const ThreadLimit limit(trial.threads);
  const Sites sites(mesh);
  std::vector<ClosestPoint> ours, reference;
  const MapOptions by_reference{.engine = make_engine("reference")};
  const Contender cpu{[&] { ours = closest_points(sites, points); }, trial.threads};
  const Contender peer{[&] { reference = closest_points(sites, points, by_reference); }, trial.threads};
  cpu.work();
  peer.work();
  bool verified = true;
  const double tolerance = 1e-6 * diagonal(bounds(mesh));
  for (std::size_t i = 0; i < points.size(); ++i)
    verified &= std::abs(ours[i].distance - reference[i].distance) <= tolerance;
  if (!verified) return {};
  const Race times = race(cpu, peer, trial.repetitions);
  const auto count = static_cast<double>(points.size());
  return {.verified = true,
          .rows = {{"",
                    {{"ratio", times.ratio},
                     {"spread", times.spread},
                     {"point_us", 1e3 * times.ours_ms / count},
                     {"reference_us", 1e3 * times.peer_ms / count}}}},
          .counts = {{"triangles", static_cast<double>(mesh.triangles.size())}, {"points", count}}};
}

Mesh large_head() {
  return refine_mesh(load("head.off"), 6, 0.1);
}
Mesh unit_armadillo() {
  return load("armadillo.off", "fit");
}

std::vector<Case> cases() {
  constexpr std::size_t kMany = 100'000;
  std::vector<Case> result;
  for (const Distribution& d : kDistributions)
    result.push_back({.name = d.name,
                      .description = std::string(d.description) + "; an armadillo of 52k triangles",
                      .run =
                          [=](const Trial& trial) {
                            const Mesh mesh = unit_armadillo();
                            return scattered(trial, mesh, d.points(mesh, kMany));
                          },
                      .repetitions = 5});
  for (const std::size_t count : {1u, 16u, 1000u, 20'000u, 100'000u, 500'000u})
    result.push_back({.name = "points-" + std::to_string(count),
                      .description = std::to_string(count) + " points around a head of 105k triangles",
                      .run =
                          [=](const Trial& trial) {
                            const Mesh mesh = large_head();
                            return scattered(trial, mesh, around_box(mesh, count));
                          },
                      .repetitions = 5});
  return result;
}

}  // namespace
}  // namespace sdm::bench

int main(int argc, char** argv) {
  using namespace sdm::bench;
  return run_program(argc, argv,
                     {.name = "scattered_points",
                      .description = "Closest points of scattered points, against the reference engine",
                      .repetition = "repetitions",
                      .cases = cases()});
}
