// The effect of culling in the gl engine (the paper's 4.2): prints a Markdown table of what is tested,
// clipped and drawn a texel, and of the time, with and without the bounds on distance, for both ways of
// clipping. Fails unless bounds change no bit of a map, all maps agree with the cpu engine, and their
// counters obey the laws of <sdm/gl.h>.
//
//   build/dev/bench/raster_culling [--resolution N] [--device NAME]
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "core/vec.h"
#include "raster_laws.h"
#include "scenes.h"
#include "scenes/reduce_mesh.h"

namespace sdm::bench {
namespace {

constexpr double kLongRun = 2000;  // milliseconds, beyond which a map is computed only once

struct Scene {
  std::string name;
  std::shared_ptr<const Surface> surface;
  std::shared_ptr<const Sites> sites;
};

struct Measured {
  DistanceMap map;
  GlReport report;
  double ms = 0;
};

Measured run_once(const Scene& scene, const std::shared_ptr<const Engine>& engine) {
  const auto start = std::chrono::steady_clock::now();
  DistanceMap map = compute_map(*scene.surface, *scene.sites, {.engine = engine, .sign = SignMethod::none});
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
  return {std::move(map), gl_report(*engine).value(), time.count()};
}

/// The median of three runs, or one long run.
Measured measure(const Scene& scene, const GlOptions& options) {
  const std::shared_ptr<const Engine> engine = make_gl_engine(options);
  Measured first = run_once(scene, engine);
  if (first.ms > kLongRun) return first;
  std::array times{first.ms, run_once(scene, engine).ms, run_once(scene, engine).ms};
  std::ranges::sort(times);
  first.ms = times[1];
  return first;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<std::uint32_t, float>,
                            std::bit_cast<std::uint32_t, float>);
}

/// Whether all distances agree to the accuracy that engines promise.
bool agree(const Scene& scene, const DistanceMap& a, const DistanceMap& b) {
  Box box = bounds(scene.surface->mesh());
  extend(box, bounds(scene.sites->mesh()));
  return std::ranges::all_of(scene.surface->samples(),
                             [&, tolerance = 2e-6 * diagonal(box)](std::uint32_t t) {
                               return std::abs(a.distance[t] - b.distance[t]) <= tolerance;
                             });
}

/// To three digits or the unit, without an exponent.
std::string number(double value) {
  char text[32];
  const int decimals = std::clamp(2 - static_cast<int>(std::floor(std::log10(std::max(value, 0.1)))), 0, 2);
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

void print_heading() {
  std::puts(
      "| map | clip | bounds | pairs | bound tests | OBB tests | clipped | polygons | fragments | ms | time "
      "|\n"
      "| --- | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
}

void print_row(const Scene& scene, const GlOptions& options, const Measured& measured,
               double ms_with_bounds) {
  const GlReport& r = measured.report;
  std::printf("| %s | %s | %s |", scene.name.c_str(), options.clip == GlClip::planes ? "planes" : "stencil",
              options.bound_culling ? "yes" : "no");
  for (const std::uint64_t count :
       {r.pairs, r.bound_tests, r.obb_tests, r.clipped_away + r.polygons, r.polygons, r.fragments})
    std::printf(" %s |", number(static_cast<double>(count) / static_cast<double>(r.texels)).c_str());
  std::printf(" %s | %s× |\n", number(measured.ms).c_str(), number(measured.ms / ms_with_bounds).c_str());
  std::fflush(stdout);
}

/// Prints the four rows of a scene. Returns whether all is as it should be.
bool tabulate(const Scene& scene, const std::string& device) {
  const DistanceMap expected = compute_map(*scene.surface, *scene.sites, {.sign = SignMethod::none});
  bool good = true;
  const auto complain = [&](const std::string& what) {
    std::fprintf(stderr, "%s: %s\n", scene.name.c_str(), what.c_str());
    good = false;
  };
  for (const GlClip clip : {GlClip::planes, GlClip::stencil}) {
    double ms_with_bounds = 0;
    std::vector<float> distances;  // with bounds
    for (const bool bounds : {true, false}) {
      const GlOptions options{.device = device, .clip = clip, .bound_culling = bounds};
      const Measured measured = measure(scene, options);
      if (bounds) ms_with_bounds = measured.ms;
      print_row(scene, options, measured, ms_with_bounds);

      for (const std::string& law : broken_laws(*scene.surface, measured.map, measured.report, options))
        complain("the counters break the law " + law);
      if (distances.empty()) {
        distances = measured.map.distance;
        if (!agree(scene, measured.map, expected)) complain("distances differ from those of the cpu engine");
      }
      if (!same_bits(measured.map.distance, distances)) complain("distances depend on culling");
    }
  }
  return good;
}

std::vector<Scene> scenes(std::uint32_t resolution) {
  const auto surface = [resolution](Mesh mesh) {
    return std::make_shared<const Surface>(std::move(mesh), AtlasOptions{.resolution = resolution});
  };
  const auto sites = [](Mesh mesh) { return std::make_shared<const Sites>(std::move(mesh)); };

  const Mesh figure = paper_figure(), box = paper_box(figure);
  std::vector<Scene> result{{"figure to box", surface(figure), sites(box)},
                            {"box to figure", surface(box), sites(figure)}};
  const auto bunny = surface(load("bunny.obj", "fit"));
  const Mesh armadillo = load("armadillo.off", "fit,translate:0.8:0:0");
  for (const std::size_t triangles : {1'000u, 10'000u, 50'000u})
    result.push_back({"bunny to armadillo of " + std::to_string(triangles / 1000) + "k", bunny,
                      sites(scenes::reduce_mesh(armadillo, triangles))});
  return result;
}

int run(int argc, char** argv) {
  std::uint32_t resolution = 256;
  std::string device;
  CLI::App app{"The effect of culling in the gl engine"};
  app.add_option("--resolution", resolution, "Texels along each side of the maps")->capture_default_str();
  app.add_option("--device", device, "A part of the name of the device that draws");
  CLI11_PARSE(app, argc, argv);

  const std::vector<Scene> all = scenes(resolution);
  // The first map of a process pays for the context.
  const Measured warm_up = run_once(all[0], make_gl_engine({.device = device}));
  std::printf("%s, %u threads, %u² texels. Times are the median of three runs, or one of over %g s.\n",
              warm_up.report.device.name.c_str(), thread_count(), resolution, kLongRun / 1000);
  std::puts("Counts are per texel: pairs of a site and a tile of a face, tests against nodes of the tree of");
  std::puts("tiles, pairs that were clipped, polygons and fragments drawn.\n");
  print_heading();
  bool good = true;
  for (const Scene& scene : all) good &= tabulate(scene, device);
  return good ? 0 : 1;
}

}  // namespace
}  // namespace sdm::bench

int main(int argc, char** argv) try {
  return sdm::bench::run(argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "raster_culling: %s\n", error.what());
  return 1;
}
