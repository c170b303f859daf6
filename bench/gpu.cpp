// The gpu engine beside the cpu engine: what a map of the bunny to the armadillo takes, and what the search
// counts, which holds without a graphics card; and the next frame of a map that is kept on the device, and
// its statistics. All figures but times are per texel. Verifies that each map equals that of the reference
// engine to the bit, or within its error if it is kept.
//
//   build/dev/bench/gpu [--device NAME] [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json
//   FILE]
#include <sdm/gpu.h>

#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "harness.h"
#include "scenes.h"
#include "timing.h"

namespace sdm::bench {
namespace {

Outcome measure(const Trial& trial, const Surface& surface, const Sites& sites, const std::string& device) {
  const auto map_by = [&](const std::shared_ptr<const Engine>& engine) {
    return compute_map(surface, sites, {.engine = engine, .sign = SignMethod::none}).distance;
  };
  const auto gpu = make_gpu_engine({.device = device}), cpu = make_engine("cpu");
  const std::vector<float> ours = map_by(gpu), expected = map_by(make_engine("reference"));
  const GpuReport report = gpu_report(*gpu).value();
  std::fprintf(stderr, "on %s\n", report.device.c_str());
  if (std::memcmp(ours.data(), expected.data(), ours.size() * sizeof(float)) != 0) return {};

  GpuMap on_device(surface, sites, {.device = device});
  const std::vector<float> kept = on_device.distances();
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const float exact = expected[surface.sample_texels()[i]];
    if (!(std::abs(kept[i] - exact) <= on_device.error(kept[i]))) return {};
  }

  const std::array contenders{
      Contender{[&] { (void)map_by(gpu); }, trial.threads},
      Contender{[&] { (void)map_by(cpu); }, trial.threads},
      Contender{[&] { on_device.compute(surface.mesh().positions, sites); }, trial.threads},
      Contender{[&] { (void)on_device.statistics(0.1); }, trial.threads}};
  const auto times = take_turns(contenders, trial.repetitions, 0);
  const double texels = static_cast<double>(report.points), ms = median(times[0]);
  const auto each = [&](std::size_t count) { return static_cast<double>(count) / texels; };
  return {.verified = true,
          .rows = {{"",
                    {{"nodes", each(report.nodes)},
                     {"tests", each(report.tests)},
                     {"candidates", each(report.candidates)},
                     {"alone", each(report.alone)},
                     {"incomplete", each(report.incomplete)},
                     {"dispatches", static_cast<double>(report.dispatches)},
                     {"upload_ms", report.upload_ms},
                     {"search_ms", report.search_ms},
                     {"finish_ms", report.finish_ms},
                     {"ms", ms},
                     {"ratio", ms / median(times[1])},
                     {"kept_ms", median(times[2])},
                     {"statistics_ms", median(times[3])}}}},
          .counts = {{"texels", texels}}};
}

std::vector<Case> cases(const std::string& device) {
  std::vector<Case> result;
  for (const std::uint32_t resolution : {256u, 512u, 1024u, 4096u})
    for (const bool apart : {true, false}) {
      const std::string size = std::to_string(resolution);
      result.push_back(
          {.name = size + (apart ? "-apart" : "-penetrating"),
           .description = "bunny to armadillo, " + size + (apart ? "², side by side" : "², penetrating"),
           .run =
               [&device, resolution, apart](const Trial& trial) {
                 const Surface surface(load("bunny.obj", "fit"), {.resolution = resolution});
                 const Sites sites(load("armadillo.off", apart ? "fit,translate:0.8:0:0" : "fit"));
                 return measure(trial, surface, sites, device);
               },
           .repetitions = 3,
           .threads = 0});
    }
  return result;
}

}  // namespace

Program program() {
  static std::string device;
  return {.name = "gpu",
          .description = "The gpu engine beside the cpu engine",
          .repetition = "repetitions",
          .cases = cases(device),
          .add_options = [](CLI::App& app) {
            app.add_option("--device", device, "A part of the name of the device that computes");
          }};
}

}  // namespace sdm::bench
