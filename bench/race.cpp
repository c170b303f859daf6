#include "race.h"

#include <array>

#include "core/parallel.h"

namespace sdm::bench {
namespace {

std::size_t texels(const Tasks& tasks) {
  std::size_t sum = 0;
  for (const MapTask* task : tasks) sum += task->texels();
  return sum;
}

Side side(const Tasks& tasks, unsigned threads, void (MapTask::*work)()) {
  const auto all = [tasks, work] {
    for (MapTask* task : tasks) (task->*work)();
  };
  return {{all, threads}, texels(tasks)};
}

std::optional<double> mtexels_s(const Side& side, const std::vector<double>& ms) {
  if (side.texels == 0) return {};
  return static_cast<double>(side.texels) / (1000 * median(ms));
}

}  // namespace

bool all_agree(const Tasks& tasks) {
  bool good = true;
  for (MapTask* task : tasks) good &= task->agrees();
  return good;
}

cpu::DescentCounts work_of(const Tasks& tasks) {
  cpu::DescentCounts sum;
  for (const MapTask* task : tasks) sum += task->work();
  return sum;
}

Side ours(const Tasks& tasks, unsigned threads) {
  return side(tasks, threads, &MapTask::compute);
}

Side embree(const Tasks& tasks) {
  return side(tasks, 1, &MapTask::ask_embree);
}

Outcome race(const Trial& trial, const Side& ours, const Side& peer, Figure asked) {
  const auto times = take_turns(trial.name, std::array{ours.contender, peer.contender}, trial.repetitions);
  const Ratio measured = ratio(times[1], times[0]);
  asked.key = "ratio";
  asked.value = measured.value;
  const unsigned threads = ours.contender.threads;
  return {.verified = true,
          .figures = {asked},
          .texels = ours.texels,
          .threads = threads > 0 ? threads : thread_count(),
          .spread = measured.spread,
          .ours_mtexels_s = mtexels_s(ours, times[0]),
          .peer_mtexels_s = mtexels_s(peer, times[1])};
}

}  // namespace sdm::bench
