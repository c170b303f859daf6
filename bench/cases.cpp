#include "cases.h"

#include <sdm/sdm.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <thread>

#include "core/parallel.h"
#include "heap.h"
#include "race.h"
#include "refine_mesh.h"
#include "scenes.h"
#include "scenes/letters.h"
#include "scenes/placement.h"
#include "scenes/reduce_mesh.h"

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

Outcome against_embree(const Trial& trial, const Tasks& tasks, double at_least) {
  if (!all_agree(tasks)) return {};
  Outcome outcome = race(trial, ours(tasks), embree(tasks), {.at_least = at_least});
  outcome.work = work_of(tasks);
  return outcome;
}

Outcome bunny_to_armadillo(const Trial& trial, std::uint32_t resolution, const char* placement,
                           double at_least) {
  MapTask task(bunny(resolution), armadillo(placement));
  return against_embree(trial, {&task}, at_least);
}

/// The paper's E and G, which overlap in part.
std::array<Mesh, 2> letter_meshes() {
  std::array result{scenes::letter_e(), scenes::letter_g()};
  scenes::place(result[1], scenes::parse_placement("rotate:10:30:5,translate:0.35:0.1:0.1"));
  return result;
}

Outcome letters(const Trial& trial) {
  const auto [e, g] = letter_meshes();
  MapTask to_g(surface(e, 512), g), to_e(surface(g, 512), e);
  return against_embree(trial, {&to_g, &to_e}, 50);
}

Outcome million(const Trial& trial) {
  constexpr double kNoise = 0.1;
  const auto o1 = surface(refine_mesh(load("bunny.obj", "fit"), 4, kNoise), 2048);
  MapTask task(o1, refine_mesh(armadillo(kPenetrating), 5, kNoise));
  return against_embree(trial, {&task}, 20);
}

Outcome box(const Trial& trial) {
  const auto o1 = bunny(1024);
  MapTask task(o1, paper_box(o1->mesh()));
  return against_embree(trial, {&task}, 40);
}

Outcome two_threads(const Trial& trial) {
  MapTask task(bunny(2048), armadillo(kPenetrating));
  if (!all_agree({&task})) return {};
  return race(trial, ours({&task}, 2), ours({&task}, 1), {.at_least = 1.8});
}

Outcome more_sites(const Trial& trial) {
  const auto o1 = bunny(512);
  const Mesh apart = armadillo(kApart), near = armadillo(kPenetrating);
  const std::size_t tenth = apart.triangles.size() / 10;
  MapTask few_apart(o1, scenes::reduce_mesh(apart, tenth)), few_near(o1, scenes::reduce_mesh(near, tenth));
  MapTask many_apart(o1, apart), many_near(o1, near);
  const Tasks few{&few_apart, &few_near}, many{&many_apart, &many_near};
  if (!all_agree(few) || !all_agree(many)) return {};
  return race(trial, ours(few), ours(many), {.at_most = 2.5});
}

Outcome more_texels(const Trial& trial) {
  const auto coarse = bunny(512), fine = bunny(2048);
  const Mesh apart = armadillo(kApart), near = armadillo(kPenetrating);
  MapTask few_apart(coarse, apart), few_near(coarse, near), many_apart(fine, apart), many_near(fine, near);
  const Tasks few{&few_apart, &few_near}, many{&many_apart, &many_near};
  if (!all_agree(few) || !all_agree(many)) return {};
  return race(trial, ours(few), ours(many), {.at_most = 8});
}

// From a mesh in memory until queries can be asked, and back: both copy its vertices and triangles, and both
// free what they made.
Outcome build(const Trial& trial) {
  const Mesh mesh = armadillo(kPenetrating);
  MapTask task(bunny(512), mesh);
  if (!all_agree({&task})) return {};
  const DeviceHandle device(rtcNewDevice(nullptr));
  const Contender ours{[&] { const Sites sites(mesh); }, 0};
  const Contender peer{[&] { (void)build_scene(device.get(), mesh, RTC_BUILD_QUALITY_MEDIUM); }, 0};
  return race(trial, {ours}, {peer}, {.at_least = 1});
}

/// The positions of a mesh that sways a little.
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
  const Contender ours{[&] { task.sites().refit(poses[pose = !pose]); }, 0};
  const Contender peer{[&] { const Sites sites(mesh); }, 0};
  return race(trial, {ours}, {peer}, {.at_least = 5});
}

Outcome memory(const Trial&) {
  const auto grown_since = [](std::ptrdiff_t before) { return static_cast<double>(heap_bytes() - before); };
  const Mesh o2 = armadillo(kPenetrating);
  std::ptrdiff_t before = heap_bytes();
  const Sites sites(o2);
  const std::size_t count = o2.positions.size() + sites.edges().size() + o2.triangles.size();
  const double bytes_a_site = grown_since(before) / static_cast<double>(count);

  Mesh o1 = load("bunny.obj", "fit");
  before = heap_bytes();
  const auto texels_of = surface(std::move(o1), 2048);
  const double surface_bytes = grown_since(before);
  if (!MapTask(texels_of, o2).agrees()) return {};

  // A thread that begins has none of the memory that others keep for the next map, and frees its own when it
  // ends: what is left then is the map.
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
  return {
      .verified = true,
      .figures = {{.key = "bytes_a_site", .value = bytes_a_site, .at_most = 200},
                  {.key = "bytes_a_texel", .value = (surface_bytes + working_bytes) / texels, .at_most = 32},
                  {.key = "surface_bytes_a_texel", .value = surface_bytes / texels},
                  {.key = "working_bytes_a_texel", .value = working_bytes / texels}},
      .texels = texels_of->samples().size()};
}

/// A frame of the letters: both sway, and both maps follow.
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
                       0};
  const double ms = median(take_turns(trial.name, std::array{cold}, trial.repetitions)[0]);
  const std::size_t texels = to_g.texels() + to_e.texels();
  return {.verified = true,
          .figures = {{.key = "ms", .value = ms, .at_most = 5}},
          .texels = texels,
          .threads = thread_count(),
          .ours_mtexels_s = static_cast<double>(texels) / (1000 * ms)};
}

}  // namespace

std::span<const Case> cases() {
  using T = const Trial&;
  static const std::vector<Case> all{
      {"dense-apart", "bunny to armadillo, apart, 2048²: Embree / ours", 3,
       [](T trial) { return bunny_to_armadillo(trial, 2048, kApart, 80); }},
      {"dense-penetrating", "bunny to armadillo, penetrating, 2048²: Embree / ours", 3,
       [](T trial) { return bunny_to_armadillo(trial, 2048, kPenetrating, 70); }},
      {"sparse-apart", "bunny to armadillo, apart, 512²: Embree / ours", 9,
       [](T trial) { return bunny_to_armadillo(trial, 512, kApart, 25); }},
      {"sparse-penetrating", "bunny to armadillo, penetrating, 512²: Embree / ours", 9,
       [](T trial) { return bunny_to_armadillo(trial, 512, kPenetrating, 20); }},
      {"letters", "letters E and G, 512², both maps: Embree / ours", 9, letters},
      {"million", "a million triangles to a million, 2048²: Embree / ours", 3, million},
      {"box", "bunny to a box around it, 1024²: Embree / ours", 5, box},
      {"threads", "dense-penetrating: one thread / two", 9, two_threads},
      {"sites", "bunny to armadillo, 512²: all its triangles / a tenth", 9, more_sites},
      {"texels", "bunny to armadillo: 2048² / 512²", 9, more_texels},
      {"build", "sites of the armadillo: Embree's tree / ours, all threads", 9, build},
      {"refit", "sites of the armadillo: build / refit, all threads", 9, refit},
      {"memory", "sites of the armadillo; bunny's atlas and map to it, 2048²", 1, memory},
      {"frame-cold", "a frame of the letters: both refitted, both maps at 512², all threads", 9, frame},
  };
  return all;
}

}  // namespace sdm::bench
