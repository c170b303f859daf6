// The effect of culling by distance bounds in the gl engine (the paper's Section 4.2), for both ways of
// clipping. "time" is the time of a row divided by that with bounds; all others but "ms" are per texel: pairs
// of a site and a tile of a face, tests against nodes of the tree of tiles, pairs that were clipped, polygons
// and fragments drawn. Verifies that bounds change no bit of a map, that distances agree with those of the
// cpu engine, and that the engine's counters are consistent.
//
//   build/dev/bench/raster_culling [--device NAME]
//                                  [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/vec.h"
#include "gl/raster_report.h"
#include "gl_counters.h"
#include "harness.h"
#include "scenes.h"
#include "scenes/reduce_mesh.h"
#include "timing.h"

namespace sdm::bench {
namespace {

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<std::uint32_t, float>,
                            std::bit_cast<std::uint32_t, float>);
}

/// Whether all distances agree to the accuracy guaranteed for engines.
bool agree(const Surface& surface, const Sites& sites, const DistanceMap& a, const DistanceMap& b) {
  Box box = bounds(surface.mesh());
  extend(box, bounds(sites.mesh()));
  return std::ranges::all_of(surface.sample_texels(), [&, tolerance = 2e-6 * diagonal(box)](std::uint32_t t) {
    return std::abs(a.distance[t] - b.distance[t]) <= tolerance;
  });
}

Row row(std::string name, const gl::RasterReport& r, double ms, double ms_with_bounds) {
  Row result{std::move(name), {}};
  for (const auto& [key, count] :
       {std::pair("pairs", r.pairs), std::pair("bound_tests", r.bound_tests),
        std::pair("obb_tests", r.obb_tests), std::pair("clipped", r.clipped_away + r.polygons),
        std::pair("polygons", r.polygons), std::pair("fragments", r.fragments)})
    result.figures.push_back({key, static_cast<double>(count) / static_cast<double>(r.texels)});
  result.figures.push_back({"ms", ms});
  result.figures.push_back({"time", ms / ms_with_bounds});
  return result;
}

Outcome measure(const Trial& trial, const Mesh& o1, const Mesh& o2, GlOptions options) {
  const Surface surface(o1, {.resolution = 256});
  const Sites sites(o2);
  options.bound_culling = true;
  const auto with_bounds = make_gl_engine(options);
  options.bound_culling = false;
  const auto without_bounds = make_gl_engine(options);
  const auto map_by = [&](const std::shared_ptr<const Engine>& engine) {
    return compute_map(surface, sites, {.engine = engine, .sign = SignMethod::none});
  };
  bool verified = true;
  const auto check = [&](bool good, const std::string& what) {
    if (!good) std::fprintf(stderr, "%s\n", what.c_str());
    verified &= good;
  };
  const DistanceMap with = map_by(with_bounds), without = map_by(without_bounds);
  const gl::RasterReport report_with = gl::raster_report(*with_bounds).value(),
                         report_without = gl::raster_report(*without_bounds).value();
  std::fprintf(stderr, "on %s\n", report_with.device.name.c_str());
  check(agree(surface, sites, with, compute_map(surface, sites, {.sign = SignMethod::none})),
        "distances differ from those of the cpu engine");
  check(same_bits(with.distance, without.distance), "distances depend on culling");
  for (const bool bounds : {true, false}) {
    options.bound_culling = bounds;
    for (const std::string& relation :
         violated_relations(surface, bounds ? with : without, bounds ? report_with : report_without, options))
      check(false, "counters violate " + relation);
  }
  if (!verified) return {};

  const std::array contenders{Contender{[&] { (void)map_by(with_bounds); }, trial.threads},
                              Contender{[&] { (void)map_by(without_bounds); }, trial.threads}};
  const auto times = take_turns(contenders, trial.repetitions, 0);
  const double ms = median(times[0]);
  return {.verified = true,
          .rows = {row("with bounds", report_with, ms, ms),
                   row("without", report_without, median(times[1]), ms)}};
}

std::vector<Case> cases(const std::string& device) {
  using Meshes = std::function<std::pair<Mesh, Mesh>()>;
  std::vector<Case> result;
  const auto add = [&](const std::string& name, const std::string& what, const Meshes& meshes) {
    for (const GlClip clip : {GlClip::planes, GlClip::stencil}) {
      const bool planes = clip == GlClip::planes;
      result.push_back(
          {.name = name + (planes ? "-planes" : "-stencil"),
           .description = what + (planes ? ", 256², clipped by planes" : ", 256², clipped by stencil"),
           .run =
               [&device, clip, meshes](const Trial& trial) {
                 const auto [o1, o2] = meshes();
                 return measure(trial, o1, o2, {.device = device, .clip = clip});
               },
           .repetitions = 3,
           .threads = 0});
    }
  };
  add("figure-to-box", "the figure to its box", figure_to_box);
  add("box-to-figure", "the box to its figure", box_to_figure);
  for (const std::size_t thousands : {1u, 10u, 50u}) {
    const std::string size = std::to_string(thousands) + "k";
    add("bunny-to-armadillo-" + size, "bunny to armadillo of " + size + " triangles", [thousands] {
      return std::pair(load("bunny.obj", "fit"),
                       scenes::reduce_mesh(load("armadillo.off", "fit,translate:0.8:0:0"), 1000 * thousands));
    });
  }
  return result;
}

}  // namespace

Program program() {
  static std::string device;
  return {.name = "raster_culling",
          .description = "The effect of culling by bounds in the gl engine",
          .repetition = "repetitions",
          .cases = cases(device),
          .add_options = [](CLI::App& app) {
            app.add_option("--device", device, "A part of the name of the device that draws");
          }};
}

}  // namespace sdm::bench
