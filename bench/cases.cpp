#include "cases.h"

#include <sdm/sdm.h>

#include <array>
#include <memory>

#include "map_task.h"
#include "measure.h"
#include "scenes.h"

namespace sdm::bench {
namespace {

constexpr const char* kApart = "fit,translate:0.8:0:0";
constexpr const char* kPenetrating = "fit,translate:0.1:0:0";

std::shared_ptr<const Surface> surface(Mesh mesh, std::uint32_t resolution) {
  return std::make_shared<const Surface>(std::move(mesh), AtlasOptions{.resolution = resolution});
}

std::shared_ptr<const Surface> bunny(std::uint32_t resolution) {
  return surface(load("bunny.obj", "fit"), resolution);
}

Mesh armadillo(const char* placement) {
  return load("armadillo.off", placement);
}

/// Maps that are measured together.
using Tasks = std::vector<MapTask*>;

std::size_t texels(const Tasks& tasks) {
  std::size_t sum = 0;
  for (const MapTask* task : tasks) sum += task->texels();
  return sum;
}

bool all_agree(const Tasks& tasks) {
  bool good = true;
  for (MapTask* task : tasks) good &= task->agrees();
  return good;
}

std::function<void()> compute_all(const Tasks& tasks) {
  return [tasks] {
    for (MapTask* task : tasks) task->compute();
  };
}

std::function<void()> ask_embree_all(const Tasks& tasks) {
  return [tasks] {
    for (MapTask* task : tasks) task->ask_embree();
  };
}

/// One that is timed, and the texels that its work fills in.
struct Side {
  Contender contender;
  std::size_t texels = 0;
};

/// The time of the peer over ours, asked to be as `asked` says.
Outcome race(const std::string& name, int repetitions, const Side& ours, const Side& peer, Figure asked) {
  const auto times = take_turns(name, std::array{ours.contender, peer.contender}, repetitions);
  const Ratio measured = ratio(times[1], times[0]);
  const auto mtexels_s = [](const Side& side, const std::vector<double>& ms) -> std::optional<double> {
    if (side.texels == 0) return {};
    return static_cast<double>(side.texels) / (1000 * median(ms));
  };
  asked.key = "ratio";
  asked.value = measured.value;
  return {.verified = true,
          .figures = {asked},
          .texels = ours.texels,
          .threads = ours.contender.threads,
          .spread = measured.spread,
          .ours_mtexels_s = mtexels_s(ours, times[0]),
          .peer_mtexels_s = mtexels_s(peer, times[1])};
}

Outcome against_embree(const std::string& name, int repetitions, const Tasks& tasks, double at_least) {
  if (!all_agree(tasks)) return {};
  return race(name, repetitions, {{compute_all(tasks)}, texels(tasks)},
              {{ask_embree_all(tasks)}, texels(tasks)}, {.at_least = at_least});
}

Outcome bunny_to_armadillo(const std::string& name, int repetitions, std::uint32_t resolution,
                           const char* placement, double at_least) {
  MapTask task(bunny(resolution), armadillo(placement));
  return against_embree(name, repetitions, {&task}, at_least);
}

}  // namespace

std::span<const Case> cases() {
  using Name = const std::string&;
  static const std::vector<Case> all{
      {"dense-apart", "bunny to armadillo, 2048², Embree / ours", 3,
       [](Name name, int n) { return bunny_to_armadillo(name, n, 2048, kApart, 80); }},
      {"dense-penetrating", "the same, penetrating", 3,
       [](Name name, int n) { return bunny_to_armadillo(name, n, 2048, kPenetrating, 70); }},
      {"sparse-apart", "bunny to armadillo, 512², Embree / ours", 9,
       [](Name name, int n) { return bunny_to_armadillo(name, n, 512, kApart, 25); }},
      {"sparse-penetrating", "the same, penetrating", 9,
       [](Name name, int n) { return bunny_to_armadillo(name, n, 512, kPenetrating, 20); }},
  };
  return all;
}

}  // namespace sdm::bench
