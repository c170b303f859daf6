// The gpu engine beside the cpu and the gl engine. Maps of the bunny to the armadillo, read back in double
// precision; what the search counts, which holds without a graphics card; and maps that stay on the device,
// by phases: upload of O2, refit of O2, search, reduction to statistics, read-back. Frames of the paper's
// scenes, and points near a surface. Counts are per texel, times in milliseconds. Verifies that each map
// equals that of the reference engine to the bit (4096²: that of the cpu engine to its accuracy), or within
// its error if it stays on the device.
//
//   build/dev/bench/gpu [--device NAME] [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json
//   FILE]
#include <sdm/gpu.h>

#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/stopwatch.h"
#include "geometry/vec.h"
#include "gpu/sites_on_device.h"
#include "harness.h"
#include "scenes.h"
#include "scenes/scene.h"
#include "timing.h"

namespace sdm::bench {
namespace {

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

MapOptions unsigned_by(const std::shared_ptr<const Engine>& engine) {
  return {.engine = engine, .sign = SignMethod::none};
}

double accuracy(const Surface& surface, const Sites& sites) {
  Box box = bounds(surface.mesh());
  extend(box, bounds(sites.mesh()));
  return 2e-6 * diagonal(box);
}

// Whether what is on the device is within its error of a map that is off by `accuracy`.
bool agree(const GpuMap& map, const Surface& surface, const std::vector<float>& expected, double accuracy) {
  const std::vector<float> found = map.distances();
  for (std::size_t i = 0; i < found.size(); ++i)
    if (!(std::abs(found[i] - expected[surface.sample_texels()[i]]) <= map.error(found[i]) + accuracy))
      return false;
  return true;
}

bool agree(const std::vector<float>& a, const std::vector<float>& b, double accuracy) {
  return std::ranges::equal(a, b, [&](float x, float y) {
    return std::abs(x - y) <= accuracy || (std::isnan(x) && std::isnan(y));
  });
}

// The engine on OpenGL, or nothing where it has no device.
std::shared_ptr<const Engine> gl_engine() {
  try {
    (void)gl_devices();
    return make_engine("gl");
  } catch (const Error& error) {
    std::fprintf(stderr, "without gl: %s\n", error.what());
    return nullptr;
  }
}

template <class Work>
double median_ms(int repetitions, const Work& work) {
  std::vector<double> times;
  Stopwatch watch;
  for (int i = 0; i < repetitions; ++i) {
    work();
    times.push_back(watch.lap());
  }
  return median(times);
}

std::vector<Figure> phases(GpuMap& map, const Surface& surface, const Sites& sites, const Trial& trial,
                           const std::string& wanted) {
  gpu::Device device(wanted);
  const sites::SitesData& o2 = internals(sites);
  gpu::SitesOnDevice on_device(device, o2);
  device.run({});
  const gpu::RefitPrograms programs(device);
  const auto refit = [&] { on_device.refit(device, programs, o2.mesh.positions, o2.frame); };
  refit();
  const std::span<const Vec3> positions = surface.mesh().positions;
  return {
      {"upload_ms", median_ms(trial.repetitions,
                              [&] {
                                const gpu::SitesOnDevice again(device, o2);
                                device.run({});
                              })},
      {"refit_ms", median_ms(trial.repetitions, refit)},
      {"search_ms", median_ms(trial.repetitions, [&] { map.compute(positions, sites); })},
      {"reduction_ms", median_ms(trial.repetitions, [&] { (void)map.statistics(0.1); })},
      {"read_back_ms", median_ms(trial.repetitions, [&] { (void)map.distances(), (void)map.closest(); })}};
}

Outcome measure(const Trial& trial, std::uint32_t resolution, bool apart, const std::string& device) {
  const Surface surface(load("bunny.obj", "fit"), {.resolution = resolution});
  const Sites sites(load("armadillo.off", apart ? "fit,translate:0.8:0:0" : "fit"));
  const auto map_by = [&](const std::shared_ptr<const Engine>& engine) {
    return compute_map(surface, sites, unsigned_by(engine)).distance;
  };
  const bool large = resolution > 2048;
  const auto gpu = make_gpu_engine({.device = device}), cpu = make_engine("cpu"),
             gl = large ? nullptr : gl_engine();
  const std::vector<float> ours = map_by(gpu), expected = map_by(large ? cpu : make_engine("reference"));
  const GpuReport report = gpu_report(*gpu).value();
  std::fprintf(stderr, "on %s\n", report.device.c_str());
  const double tolerance = large ? accuracy(surface, sites) : 0;
  if (large ? !agree(ours, expected, tolerance)
            : std::memcmp(ours.data(), expected.data(), ours.size() * sizeof(float)) != 0)
    return {};
  GpuMap on_device(surface, sites, {.device = device, .closest = true});
  if (!agree(on_device, surface, expected, tolerance)) return {};
  on_device.compute(surface.mesh().positions, sites.mesh().positions);
  if (!agree(on_device, surface, expected, tolerance)) return {};

  std::vector<Contender> contenders{Contender{[&] { (void)map_by(gpu); }, trial.threads},
                                    Contender{[&] { (void)map_by(cpu); }, trial.threads}};
  if (gl) contenders.push_back({[&] { (void)map_by(gl); }, trial.threads});
  const auto times = take_turns(contenders, trial.repetitions, 0);
  const double texels = static_cast<double>(report.points), ms = median(times[0]), cpu_ms = median(times[1]);
  const auto each = [&](std::size_t count) { return static_cast<double>(count) / texels; };
  Row row{"",
          {{"cpu_ms", cpu_ms},
           {"gl_ms", gl ? median(times[2]) : kAbsent},
           {"gpu_ms", ms},
           {"gpu/cpu", ms / cpu_ms},
           {"upload", report.upload_ms},
           {"search", report.search_ms},
           {"finish", report.finish_ms},
           {"nodes", each(report.nodes)},
           {"tests", each(report.tests)},
           {"candidates", each(report.candidates)},
           {"alone", each(report.alone)},
           {"incomplete", each(report.incomplete)},
           {"dispatches", static_cast<double>(report.dispatches)}}};
  const std::vector<Figure> of_phases = phases(on_device, surface, sites, trial, device);
  row.figures.insert(row.figures.begin() + 4, of_phases.begin(), of_phases.end());
  return {.verified = true, .rows = {row}, .counts = {{"texels", texels}}};
}

// Frames in which both bodies move: vertices to the map, its statistics, and the map in double precision.
Outcome measure_frames(const Trial& trial, scenes::SceneKind kind, const std::string& device) {
  scenes::Scene scene(kind, {.mesh = mesh_file("bunny.obj")});
  const auto positions = [&](int body) { return scene.bodies()[body].mesh.positions; };
  Surface surface(scene.bodies()[0].mesh, {.resolution = 512});
  Sites sites(scene.bodies()[1].mesh);
  const auto gpu = make_gpu_engine({.device = device}), cpu = make_engine("cpu"), gl = gl_engine();
  GpuMap map(surface, sites, {.device = device});
  std::vector<double> update, on_device, reduction, by_gpu, by_cpu, by_gl;
  DistanceMap read, expected, drawn;
  bool verified = true;
  for (int frame = 0; frame <= trial.repetitions; ++frame) {
    const std::vector<Vec3> a = positions(0), b = positions(1);
    Stopwatch watch;
    map.compute(a, b);
    on_device.push_back(watch.lap());
    (void)map.statistics(0.1);
    reduction.push_back(watch.lap());
    surface.refit(a);
    sites.refit(b);
    update.push_back(watch.lap());
    compute_map(surface, sites, unsigned_by(gpu), read);
    by_gpu.push_back(watch.lap());
    compute_map(surface, sites, unsigned_by(cpu), expected);
    by_cpu.push_back(watch.lap());
    if (gl) {
      compute_map(surface, sites, unsigned_by(gl), drawn);
      by_gl.push_back(watch.lap());
    }
    if (frame == 0)  // performs all allocations
      for (auto* times : {&update, &on_device, &reduction, &by_gpu, &by_cpu, &by_gl}) times->clear();
    const double tolerance = accuracy(surface, sites);
    verified &= agree(read.distance, expected.distance, tolerance) &&
                agree(map, surface, expected.distance, tolerance);
    scene.advance();
  }
  return {.verified = verified,
          .rows = {{"",
                    {{"device_ms", median(on_device)},
                     {"reduction_ms", median(reduction)},
                     {"refit_on_cpu_ms", median(update)},
                     {"gpu_ms", median(by_gpu)},
                     {"cpu_ms", median(by_cpu)},
                     {"gl_ms", gl ? median(by_gl) : kAbsent}}}}};
}

// Points within a hundredth of the size of a surface.
Outcome measure_points(const Trial& trial, const std::string& device) {
  constexpr std::size_t kCount = 1'000'000;
  const Surface surface(load("bunny.obj", "fit"), {.resolution = 1024});
  const Sites sites(surface.mesh());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> offset(-0.01, 0.01);
  const std::vector<Vec3> samples = surface.sample_points();
  std::vector<Vec3> points(kCount);
  for (Vec3& p : points)
    p = samples[random() % samples.size()] + Vec3{offset(random), offset(random), offset(random)};
  const auto gpu = make_gpu_engine({.device = device}), cpu = make_engine("cpu");
  std::vector<ClosestPoint> ours, expected;
  const std::array contenders{
      Contender{[&] { ours = closest_points(sites, points, {.engine = gpu}); }, trial.threads},
      Contender{[&] { expected = closest_points(sites, points, {.engine = cpu}); }, trial.threads}};
  for (const Contender& each : contenders) each.work();
  const double tolerance = accuracy(surface, sites);
  for (std::size_t i = 0; i < kCount; ++i)
    if (!(std::abs(ours[i].distance - expected[i].distance) <= tolerance)) return {};
  const auto times = take_turns(contenders, trial.repetitions, 0);
  const double ms = median(times[0]), cpu_ms = median(times[1]);
  return {.verified = true,
          .rows = {{"",
                    {{"gpu_points_per_s", 1000 * kCount / ms},
                     {"cpu_points_per_s", 1000 * kCount / cpu_ms},
                     {"gpu/cpu", ms / cpu_ms}}}}};
}

std::vector<Case> cases(const std::string& device) {
  std::vector<Case> result;
  const auto add = [&](std::string name, std::string description, int repetitions, const auto& run) {
    result.push_back({.name = std::move(name),
                      .description = std::move(description),
                      .run = run,
                      .repetitions = repetitions,
                      .threads = 0});
  };
  for (const std::uint32_t resolution : {256u, 512u, 1024u, 4096u})
    for (const bool apart : {true, false}) {
      const std::string size = std::to_string(resolution);
      add(size + (apart ? "-apart" : "-penetrating"),
          "bunny to armadillo, " + size + (apart ? "², side by side" : "², penetrating"), 3,
          [&device, resolution, apart](const Trial& trial) {
            return measure(trial, resolution, apart, device);
          });
    }
  for (const auto kind : {scenes::SceneKind::letters, scenes::SceneKind::bunnies}) {
    const std::string name = kind == scenes::SceneKind::letters ? "letters" : "bunnies";
    add("frames-" + name, "the scene of two " + name + ", 512², in one direction", 30,
        [&device, kind](const Trial& trial) { return measure_frames(trial, kind, device); });
  }
  add("points", "a million points near the bunny", 3,
      [&device](const Trial& trial) { return measure_points(trial, device); });
  return result;
}

}  // namespace

Program program() {
  static std::string device;
  return {.name = "gpu",
          .description = "The gpu engine beside the cpu and the gl engine",
          .repetition = "repetitions, or frames",
          .cases = cases(device),
          .add_options = [](CLI::App& app) {
            app.add_option("--device", device, "A part of the name of the device that computes");
          }};
}

}  // namespace sdm::bench
