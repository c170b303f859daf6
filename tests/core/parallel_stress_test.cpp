#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/execution.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "core/parallel.h"

namespace sdm {
namespace {

/// Nested loops and tasks of one caller, some of them under limits or with a part that throws. Returns the
/// number of indices that are to be visited.
long visit(unsigned caller, int rounds, std::atomic<long>& visited) {
  const auto count = [&](std::size_t begin, std::size_t end) { visited += static_cast<long>(end - begin); };
  for (int round = 0; round < rounds; ++round) {
    std::unique_ptr<ThreadLimit> limit;
    if (caller % 2 == 1)
      limit = std::make_unique<ThreadLimit>(1 + (static_cast<unsigned>(round) + caller) % 5);
    const auto fail = [](std::size_t begin, std::size_t) {
      if (begin == 25) throw Error("stop");
    };
    if (round % 7 == 3) {
      EXPECT_THROW(parallel_for(50, 1, fail), Error);
    }
    parallel_for(20, 1, [&](std::size_t begin, std::size_t end) {
      for (; begin < end; ++begin) parallel_for(30, 4, count);
    });
    parallel_tasks([&](Tasks& tasks) {
      for (int i = 0; i < 10; ++i) tasks.add([&] { parallel_for(10, 1, count); });
    });
  }
  return rounds * (20 * 30 + 10 * 10);
}

TEST(ParallelFor, ManyCallersNestLoopsAndTasks) {
  std::atomic<long> visited{0}, expected{0};
  std::vector<std::thread> callers;
  for (unsigned caller = 0; caller < 6; ++caller)
    callers.emplace_back([&, caller] { expected += visit(caller, 40, visited); });
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(visited, expected);
}

}  // namespace
}  // namespace sdm
