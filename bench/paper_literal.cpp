// The paper's Algorithm 1 as it is printed, and each correction of the gl engine
// (research/literal/corrections.h) added to it alone, and removed alone from the engine. Errors are those
// of |distance|, in millionths of the diagonal of the bounding box of both meshes, over texels with a value;
// "wrong" is the percentage of texels whose distance, site or vector is wrong by more than the accuracy of
// the engine, or that have no value; "none" that of the latter; "repaired" that of texels that the cpu engine
// recomputed. Verifies that the engine with all corrections agrees with the reference engine. All rows clip
// by the stencil.
//
//   build/dev/bench/paper_literal [--device NAME]
//                                 [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "gl/raster_report.h"
#include "harness.h"
#include "research/figures/corrections.h"
#include "research/literal/literal_engine.h"
#include "scenes.h"
#include "scenes/reduce_mesh.h"
#include "scenes/scene.h"
#include "timing.h"

namespace sdm::bench {
namespace {

std::vector<figures::Variant> variants() {
  std::vector<figures::Variant> result = figures::added_corrections();
  std::ranges::move(figures::removed_corrections(), std::back_inserter(result));
  return result;
}

Outcome measure(const Trial& trial, const Mesh& o1, const Mesh& o2, std::uint32_t resolution,
                const std::string& device) {
  const Surface surface(o1, {.resolution = resolution});
  const Sites sites(o2);
  const auto map_by = [&](const std::shared_ptr<const Engine>& engine) {
    return compute_map(surface, sites, {.engine = engine, .sign = SignMethod::none});
  };
  const DistanceMap reference = map_by(make_engine("reference"));
  Outcome outcome{.verified = true};
  std::vector<Contender> contenders;
  for (const figures::Variant& variant : variants()) {
    const auto engine = literal::make_engine({.device = device}, variant.corrections);
    const figures::MapErrors e = figures::errors_of(map_by(engine), reference, surface, sites);
    const gl::RasterReport report = literal::report(*engine).value();
    const auto texels = static_cast<double>(report.texels);
    if (outcome.rows.empty() && e.wrong > 0) {
      std::fprintf(stderr, "the map with all corrections is wrong\n");
      return {};
    }
    contenders.push_back({[&map_by, engine] { (void)map_by(engine); }, trial.threads});
    outcome.rows.push_back({variant.name,
                            {{"max_error_ppm", 1e6 * e.largest},
                             {"mean_error_ppm", 1e6 * e.mean},
                             {"wrong_percent", e.wrong},
                             {"none_percent", e.none},
                             {"repaired_percent", 100 * static_cast<double>(report.unconfirmed) / texels},
                             {"polygons", static_cast<double>(report.polygons) / texels}}});
  }
  const auto times = take_turns(contenders, trial.repetitions, 0);
  for (std::size_t i = 0; i < times.size(); ++i) outcome.rows[i].figures.push_back({"ms", median(times[i])});
  return outcome;
}

std::vector<Case> cases(const std::string& device) {
  using Meshes = std::function<std::pair<Mesh, Mesh>()>;
  std::vector<Case> result;
  const auto add = [&](const std::string& name, const std::string& what, std::uint32_t resolution,
                       const Meshes& meshes) {
    result.push_back({.name = name,
                      .description = what + ", " + std::to_string(resolution) + "²",
                      .run =
                          [&device, resolution, meshes](const Trial& trial) {
                            const auto [o1, o2] = meshes();
                            return measure(trial, o1, o2, resolution, device);
                          },
                      .repetitions = 3,
                      .threads = 0});
  };
  const auto first_frame = [](scenes::SceneKind kind) {
    return [kind] {
      const scenes::Scene scene(kind);
      return std::pair(scene.bodies()[0].mesh, scene.bodies()[1].mesh);
    };
  };
  add("letters", "letter E to letter G", 256, first_frame(scenes::SceneKind::letters));
  add("bunnies", "one bunny of 2k triangles to the other", 256, first_frame(scenes::SceneKind::bunnies));
  add("figure-to-box", "the figure to its box", 256, figure_to_box);
  add("box-to-figure", "the box to its figure", 128, box_to_figure);
  const auto armadillo = [](const char* steps) {
    return scenes::reduce_mesh(load("armadillo.off", steps), 10000);
  };
  add("apart", "bunny to armadillo of 10k triangles, side by side", 256,
      [armadillo] { return std::pair(load("bunny.obj", "fit"), armadillo("fit,translate:0.8:0:0")); });
  add("penetrating", "bunny of 2k triangles to armadillo of 10k inside it", 256, [armadillo] {
    return std::pair(scenes::reduce_mesh(load("bunny.obj", "fit"), 2000), armadillo("fit"));
  });
  return result;
}

}  // namespace

Program program() {
  static std::string device;
  return {.name = "paper_literal",
          .description = "The paper's Algorithm 1 as it is printed, and the effect of each correction",
          .repetition = "repetitions",
          .cases = cases(device),
          .add_options = [](CLI::App& app) {
            app.add_option("--device", device, "A part of the name of the device that draws");
          }};
}

}  // namespace sdm::bench
