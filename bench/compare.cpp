// Maps of the cpu engine against Embree's closest-point queries, texel by texel; scaling with threads, sites
// and texels; building, refitting and memory. "ratio" is the peer's time divided by ours; each case's
// description names the two.
//
//   build/dev/bench/compare [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <sdm/execution.h>
#include <sdm/sdm.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <thread>

#include "harness.h"
#include "heap.h"
#include "io/mesh/placement.h"
#include "map_task.h"
#include "refine_mesh.h"
#include "scenes.h"
#include "scenes/letters.h"
#include "scenes/reduce_mesh.h"
#include "timing.h"

namespace sdm::bench {
namespace {

constexpr const char* kApart = "fit,translate:0.8:0:0";
constexpr const char* kPenetrating = "fit,translate:0.1:0:0";

std::shared_ptr<Surface> surface(Mesh mesh, std::uint32_t resolution) {
  return std::make_shared<Surface>(std::move(mesh), AtlasOptions{.resolution = resolution});
}

std::shared_ptr<Surface> bunny(std::uint32_t resolution) {
  return surface(load("bunny.obj", "fit"), resolution);
}

Mesh armadillo(const char* placement) {
  return load("armadillo.off", placement);
}

Outcome compare(const Trial& trial, const Contender& ours, const Contender& peer) {
  return {.verified = true, .rows = {{.figures = race(ours, peer, trial.repetitions).figures()}}};
}

double mtexels_s(double texels, double ms) {
  return texels / (1000 * ms);
}

Outcome against_embree(const Trial& trial, const Tasks& tasks) {
  if (!all_agree(tasks)) return {};
  const Race result = race(ours(tasks, trial.threads), embree(tasks, trial.threads), trial.repetitions);
  std::vector<Figure> figures = result.figures(), counts = work_figures(tasks);
  const double texels = counts[0].value;
  figures.push_back({"ours_mtexels_s", mtexels_s(texels, result.ours_ms)});
  figures.push_back({"peer_mtexels_s", mtexels_s(texels, result.peer_ms)});
  return {.verified = true, .rows = {{.figures = figures}}, .counts = counts};
}

Outcome bunny_to_armadillo(const Trial& trial, std::uint32_t resolution, const char* placement) {
  MapTask task(bunny(resolution), armadillo(placement));
  return against_embree(trial, {&task});
}

/// The paper's E and G, which overlap partially.
std::array<Mesh, 2> letter_meshes() {
  std::array result{scenes::letter_e(), scenes::letter_g()};
  io::place(result[1], io::parse_placement("rotate:10:30:5,translate:0.35:0.1:0.1"));
  return result;
}

Outcome letters(const Trial& trial) {
  const auto [e, g] = letter_meshes();
  MapTask to_g(surface(e, 512), g), to_e(surface(g, 512), e);
  return against_embree(trial, {&to_g, &to_e});
}

Outcome million(const Trial& trial) {
  constexpr double kNoise = 0.1;
  const auto o1 = surface(refine_mesh(load("bunny.obj", "fit"), 4, kNoise), 2048);
  MapTask task(o1, refine_mesh(armadillo(kPenetrating), 5, kNoise));
  return against_embree(trial, {&task});
}

Outcome box(const Trial& trial) {
  const auto o1 = bunny(1024);
  MapTask task(o1, paper_box(o1->mesh()));
  return against_embree(trial, {&task});
}

Outcome two_threads(const Trial& trial) {
  MapTask task(bunny(2048), armadillo(kPenetrating));
  if (!all_agree({&task})) return {};
  return compare(trial, ours({&task}, 2), ours({&task}, 1));
}

/// Bunny to armadillo, apart and penetrating: the maps of both placements.
struct BothPlacements {
  MapTask apart, near;

  BothPlacements(const std::shared_ptr<Surface>& o1, const Mesh& o2_apart, const Mesh& o2_near)
      : apart(o1, o2_apart), near(o1, o2_near) {}

  Tasks tasks() { return {&apart, &near}; }
};

Outcome compare_maps(const Trial& trial, BothPlacements& few, BothPlacements& many) {
  if (!all_agree(few.tasks()) || !all_agree(many.tasks())) return {};
  return compare(trial, ours(few.tasks(), trial.threads), ours(many.tasks(), trial.threads));
}

Outcome more_sites(const Trial& trial) {
  const auto o1 = bunny(512);
  const Mesh apart = armadillo(kApart), near = armadillo(kPenetrating);
  const std::size_t tenth = apart.triangles.size() / 10;
  BothPlacements few(o1, scenes::reduce_mesh(apart, tenth), scenes::reduce_mesh(near, tenth)),
      many(o1, apart, near);
  return compare_maps(trial, few, many);
}

Outcome more_texels(const Trial& trial) {
  const Mesh apart = armadillo(kApart), near = armadillo(kPenetrating);
  BothPlacements few(bunny(512), apart, near), many(bunny(2048), apart, near);
  return compare_maps(trial, few, many);
}

// From a mesh in memory to a structure ready for queries, including its destruction; both libraries copy the
// vertices and triangles.
Outcome build(const Trial& trial) {
  const Mesh mesh = armadillo(kPenetrating);
  MapTask task(bunny(512), mesh);
  if (!all_agree({&task})) return {};
  const DeviceHandle device(rtcNewDevice(nullptr));
  const Contender ours{[&] { const Sites sites(mesh); }, trial.threads};
  const Contender peer{[&] { (void)build_scene(device.get(), mesh, RTC_BUILD_QUALITY_MEDIUM); },
                       trial.threads};
  return compare(trial, ours, peer);
}

/// The positions of a slightly swaying mesh.
std::vector<Vec3> swayed(const Mesh& mesh, double amplitude) {
  std::vector<Vec3> positions = mesh.positions;
  for (Vec3& p : positions) p[0] += amplitude * std::sin(2 * std::numbers::pi * p[1]);
  return positions;
}

Outcome refit(const Trial& trial) {
  const Mesh mesh = armadillo(kPenetrating);
  const std::array poses{mesh.positions, swayed(mesh, 0.05)};
  const auto o1 = bunny(512);
  MapTask task(o1, mesh);
  task.refit(o1->mesh().positions, poses[1]);
  if (!all_agree({&task})) return {};
  bool pose = false;
  const Contender ours{[&] { task.sites().refit(poses[pose = !pose]); }, trial.threads};
  const Contender peer{[&] { const Sites sites(mesh); }, trial.threads};
  return compare(trial, ours, peer);
}

Outcome memory(const Trial&) {
  const auto grown_since = [](std::ptrdiff_t before) { return static_cast<double>(heap_bytes() - before); };
  const Mesh o2 = armadillo(kPenetrating);
  std::ptrdiff_t before = heap_bytes();
  const Sites sites(o2);
  const std::size_t count = o2.positions.size() + sites.edges().size() + o2.triangles.size();
  const double bytes_per_site = grown_since(before) / static_cast<double>(count);

  Mesh o1 = load("bunny.obj", "fit");
  before = heap_bytes();
  const auto texels_of = surface(std::move(o1), 2048);
  const double surface_bytes = grown_since(before);
  if (!MapTask(texels_of, o2).agrees()) return {};

  // A new thread has no working memory from earlier maps, and frees its own when it ends: what remains is the
  // map.
  DistanceMap map;
  double peak = 0;
  before = heap_bytes();
  std::thread([&] {
    const ThreadLimit alone(1);
    (void)heap_peak();
    compute_map(*texels_of, sites, {.sign = SignMethod::none}, map);
    peak = static_cast<double>(heap_peak() - before);
  }).join();
  const double working_bytes = peak - grown_since(before);

  const double texels = 2048.0 * 2048.0;
  return {.verified = true,
          .rows = {{.figures = {{"bytes_per_site", bytes_per_site},
                                {"bytes_per_texel", (surface_bytes + working_bytes) / texels},
                                {"surface_bytes_per_texel", surface_bytes / texels},
                                {"working_bytes_per_texel", working_bytes / texels}}}}};
}

/// A frame of the letters: both sway, and both maps are recomputed.
Outcome frame(const Trial& trial) {
  const auto [e, g] = letter_meshes();
  const std::array e_poses{e.positions, swayed(e, 0.01)}, g_poses{g.positions, swayed(g, 0.01)};
  MapTask to_g(surface(e, 512), g), to_e(surface(g, 512), e);
  to_g.refit(e_poses[1], g_poses[1]);
  to_e.refit(g_poses[1], e_poses[1]);
  if (!all_agree({&to_g, &to_e})) return {};

  bool pose = false;
  const Contender cold{[&] {
                         pose = !pose;
                         to_g.surface().refit(e_poses[pose]);
                         to_g.sites().refit(g_poses[pose]);
                         to_e.surface().refit(g_poses[pose]);
                         to_e.sites().refit(e_poses[pose]);
                         to_g.compute();
                         to_e.compute();
                       },
                       trial.threads};
  const double ms = median(take_turns(std::array{cold}, trial.repetitions)[0]);
  const auto texels = static_cast<double>(to_g.texels() + to_e.texels());
  return {.verified = true,
          .rows = {{.figures = {{"ms", ms}, {"ours_mtexels_s", mtexels_s(texels, ms)}}}},
          .counts = {{"texels", texels}}};
}

std::vector<Case> cases() {
  using T = const Trial&;
  constexpr unsigned kAllCores = 0;
  return {
      {"dense-apart", "bunny to armadillo, apart, 2048²: Embree / ours",
       [](T trial) { return bunny_to_armadillo(trial, 2048, kApart); }, 3},
      {"dense-penetrating", "bunny to armadillo, penetrating, 2048²: Embree / ours",
       [](T trial) { return bunny_to_armadillo(trial, 2048, kPenetrating); }, 3},
      {"sparse-apart", "bunny to armadillo, apart, 512²: Embree / ours",
       [](T trial) { return bunny_to_armadillo(trial, 512, kApart); }},
      {"sparse-penetrating", "bunny to armadillo, penetrating, 512²: Embree / ours",
       [](T trial) { return bunny_to_armadillo(trial, 512, kPenetrating); }},
      {"letters", "letters E and G, 512², both maps: Embree / ours", letters},
      {"million", "a million triangles to a million, 2048²: Embree / ours", million, 3},
      {"box", "bunny to a box around it, 1024²: Embree / ours", box, 5},
      {"threads", "dense-penetrating: one thread / two; --threads is ignored", two_threads},
      {"sites", "bunny to armadillo, 512²: all its triangles / a tenth", more_sites},
      {"texels", "bunny to armadillo: 2048² / 512²", more_texels},
      {"build", "sites of the armadillo: building Embree's tree / ours", build, 9, kAllCores},
      {"refit", "sites of the armadillo: build / refit", refit, 9, kAllCores},
      {"memory", "sites of the armadillo; atlas of the bunny and its map, 2048²; one thread", memory, 1},
      {"frame-cold", "a frame of the letters: both refitted, both maps at 512²", frame, 9, kAllCores},
  };
}

}  // namespace

Program program() {
  return {.name = "compare",
          .description = "Maps of the cpu engine against Embree's closest-point queries",
          .repetition = "repetitions",
          .cases = cases()};
}

}  // namespace sdm::bench
