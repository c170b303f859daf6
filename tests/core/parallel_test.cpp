#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/execution.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "core/parallel.h"

namespace sdm {
namespace {

TEST(ParallelFor, VisitsEveryIndexOnceForAnyGrainAndThreadCount) {
  for (unsigned threads : {1u, 2u, 5u})
    for (std::size_t grain : {1u, 7u, 100000u}) {
      const ThreadLimit limit(threads);
      EXPECT_EQ(thread_count(), threads);
      std::vector<std::atomic<int>> visits(10007);
      parallel_for(visits.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_TRUE(std::all_of(visits.begin(), visits.end(), [](const auto& v) { return v == 1; }));
    }
}

// Once, the end went unreported when the last to finish found another thread reporting.
TEST(ParallelFor, ReportsProgressUpToTheEndAndPassesExceptionsOn) {
  for (int repeat = 0; repeat < 20; ++repeat) {
    double last = 0;
    parallel_for(
        1000, 10,
        [&](std::string_view step, double fraction) {
          EXPECT_EQ(step, "work");
          EXPECT_GE(fraction, last);
          if (last == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
          last = fraction;
          return true;
        },
        "work", [](std::size_t, std::size_t) {});
    EXPECT_EQ(last, 1);
  }
  EXPECT_THROW(parallel_for(100, 1, [](std::size_t, std::size_t) { throw Error("stop"); }), Error);
}

TEST(ParallelFor, StopsWhenProgressSaysSo) {
  std::atomic<std::size_t> calls{0};
  const auto work = [&](std::size_t, std::size_t) { ++calls; };
  EXPECT_THROW(parallel_for(
                   100000, 1, [](std::string_view, double) { return false; }, "work", work),
               Cancelled);
  EXPECT_LT(calls, 100000u);
}

// Once, a failing branch left loops in the other branch undone without telling it.
TEST(ParallelInvoke, AnExceptionLeavesTheLoopsOfTheOtherBranchWhole) {
  for (int repeat = 0; repeat < 50; ++repeat) {
    std::atomic<int> expected{0}, visited{0};
    const auto loops = [&] {
      for (int loop = 0; loop < 100; ++loop) {
        expected += 64;
        parallel_for(64, 1, [&](std::size_t, std::size_t) { ++visited; });
      }
    };
    EXPECT_THROW(parallel_invoke([] { throw Error("stop"); }, loops), Error);
    EXPECT_EQ(visited, expected);
    EXPECT_THROW(parallel_for(2, 1,
                              [&](std::size_t begin, std::size_t) {
                                if (begin == 0) throw Error("stop");
                                loops();
                              }),
                 Error);
    EXPECT_EQ(visited, expected);
  }
}

// Regression: a thread waiting in a nested loop started another iteration of the outer loop while holding a
// lock.
TEST(ParallelTasks, RunsAllThatIsAddedAndPassesExceptionsOn) {
  std::atomic<int> leaves{0};
  const std::function<void(Tasks&, int)> split = [&](Tasks& tasks, int depth) {
    if (depth == 0) {
      ++leaves;
      return;
    }
    tasks.add([&, depth] { split(tasks, depth - 1); });
    split(tasks, depth - 1);
  };
  parallel_tasks([&](Tasks& tasks) { split(tasks, 10); });
  EXPECT_EQ(leaves, 1024);
  EXPECT_THROW(parallel_tasks([](Tasks& tasks) { tasks.add([] { throw Error("stop"); }); }), Error);
}

TEST(ParallelFor, AWaitingThreadTakesUpNoOtherWork) {
  const ThreadLimit limit(4);
  std::mutex mutex;
  std::atomic<int> visits{0};
  parallel_for(200, 1, [&](std::size_t, std::size_t) {
    const std::lock_guard lock(mutex);
    parallel_for(50, 1, [&](std::size_t, std::size_t) { ++visits; });
  });
  EXPECT_EQ(visits, 200 * 50);
}

// Once, a thread that had finished its step waited for the loops of the other step, which ran on one core.
TEST(ParallelInvoke, AThreadThatHasFinishedHelpsWithTheLoopsOfTheOtherStep) {
  const ThreadLimit limit(2);
  std::mutex mutex;
  std::set<std::thread::id> threads;
  const auto loop = [&] {
    // Ends once both threads have met, or after 20 s.
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    const auto both = [&] {
      const std::lock_guard lock(mutex);
      threads.insert(std::this_thread::get_id());
      return threads.size() == 2;
    };
    parallel_for(1000, 1, [&](std::size_t, std::size_t) {
      while (!both() && std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(std::chrono::microseconds(100));
    });
  };
  std::atomic<bool> begun = false;
  parallel_invoke(
      [&] {
        while (!begun) std::this_thread::yield();
      },
      [&] {
        begun = true;
        loop();
      });
  EXPECT_EQ(threads.size(), 2u);
}

// The other work might need a lock that the thread holds.
TEST(ParallelInvoke, AThreadThatWaitsWithALockTakesUpNoOtherWork) {
  const ThreadLimit limit(4);
  std::mutex mutex;
  std::atomic<int> visits{0};
  parallel_steps(50, [&](std::size_t) {
    const std::lock_guard lock(mutex);
    const Alone alone;
    parallel_invoke([&] { ++visits; },
                    [&] { parallel_for(50, 1, [&](std::size_t, std::size_t) { ++visits; }); });
  });
  EXPECT_EQ(visits, 50 * 51);
}

}  // namespace
}  // namespace sdm
