// The map of the bunny to the armadillo against one rtcPointQuery of Embree's a texel: on the same texels in
// the same order, with the same threads, in the same run, repetitions interleaved at random, both into memory
// that they have already. Both results are compared first, and the program fails when they disagree. It
// prints the medians and their ratio for two placements.
//
//   build/dev/bench/map_vs_embree [--resolution N] [--threads N] [--benchmark_filter=sdm ...]
#include <benchmark/benchmark.h>
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>

#include "core/parallel.h"
#include "core/vec.h"
#include "embree_map.h"
#include "scenes.h"

namespace sdm::bench {
namespace {

struct Scene {
  std::string name;
  std::shared_ptr<const Surface> surface;
  Sites sites;
  EmbreeScene embree;
  std::vector<EmbreeTexel> texels;
  DistanceMap map;

  Scene(std::string scene_name, std::shared_ptr<const Surface> o1, const Mesh& o2)
      : name(std::move(scene_name)), surface(std::move(o1)), sites(o2), embree(o2) {
    for (const Vec3& p : surface->sample_points())
      texels.push_back(
          {.point = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])}});
  }

  void compute() { compute_map(*surface, sites, {.sign = SignMethod::none}, map); }

  /// Whether both agree at every texel to the accuracy of single precision in the scene.
  bool agrees() {
    compute();
    embree.closest(texels);
    Box box = bounds(surface->mesh());
    extend(box, bounds(sites.mesh()));
    const double tolerance = 1e-6 * diagonal(box);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < texels.size(); ++i)
      wrong += !(std::abs(map.distance[surface->samples()[i]] - texels[i].distance) <= tolerance);
    if (wrong > 0)
      std::fprintf(stderr, "%s: %zu of %zu texels disagree\n", name.c_str(), wrong, texels.size());
    return wrong == 0;
  }
};

/// Prints as usual and keeps the medians.
class MedianReporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs)
      if (run.aggregate_name == "median") medians[run.run_name.function_name] = run.GetAdjustedRealTime();
  }
  std::map<std::string, double> medians;
};

template <class Work>
void add(const std::string& name, std::size_t texels, Work work) {
  benchmark::RegisterBenchmark(
      name.c_str(),
      [work, texels](benchmark::State& state) {
        for (auto _ : state) work();
        state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(texels));
      })
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond)
      ->MinTime(0.1)
      ->Repetitions(9);
}

int run(int argc, char** argv) {
  std::uint32_t resolution = 1024;
  unsigned threads = 0;
  CLI::App app{"The map of the bunny to the armadillo against Embree's point queries"};
  app.allow_extras();  // for the benchmark library
  app.add_option("--resolution", resolution, "Texels along each side of the map")->capture_default_str();
  app.add_option("--threads", threads, "Threads of both; 0: one a core")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::vector<std::string> extras = app.remaining();
  extras.insert(extras.begin(), {argv[0], "--benchmark_enable_random_interleaving=true"});
  std::vector<char*> arguments;
  for (std::string& extra : extras) arguments.push_back(extra.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;

  const ThreadLimit limit(threads);
  const auto surface =
      std::make_shared<const Surface>(load("bunny.obj", "fit"), AtlasOptions{.resolution = resolution});
  std::vector<std::unique_ptr<Scene>> scenes;
  scenes.push_back(std::make_unique<Scene>("apart", surface, load("armadillo.off", "fit,translate:0.8:0:0")));
  scenes.push_back(
      std::make_unique<Scene>("penetrating", surface, load("armadillo.off", "fit,translate:0.1:0:0")));
  for (const auto& scene : scenes) {
    if (!scene->agrees()) return 1;
    add("sdm/" + scene->name, scene->texels.size(), [&s = *scene] { s.compute(); });
    add("embree/" + scene->name, scene->texels.size(), [&s = *scene] { s.embree.closest(s.texels); });
  }
  std::printf("%zu texels, %u threads; results agree.\n", surface->samples().size(), thread_count());
  MedianReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  for (const auto& scene : scenes)
    if (reporter.medians.contains("sdm/" + scene->name) && reporter.medians.contains("embree/" + scene->name))
      std::printf("%s: sdm is %.2f times as fast as Embree\n", scene->name.c_str(),
                  reporter.medians["embree/" + scene->name] / reporter.medians["sdm/" + scene->name]);
  return 0;
}

}  // namespace
}  // namespace sdm::bench

int main(int argc, char** argv) try { return sdm::bench::run(argc, argv); } catch (const sdm::Error& error) {
  std::fprintf(stderr, "map_vs_embree: %s\n", error.what());
  return 1;
}
