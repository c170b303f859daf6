// The loops of core/parallel.h on oneTBB.
#include <sdm/execution.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <utility>

#include "core/cancellation.h"
#include "core/parallel.h"

namespace sdm::core {

unsigned thread_count() {
  return static_cast<unsigned>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

namespace {

// Declares to ThreadSanitizer the order that oneTBB, which is not compiled with it, enforces: a part begins
// after it was added, and the loop returns after all parts have ended. Empty in other builds.
class Order {
 public:
#ifdef __SANITIZE_THREAD__
  void part_added() {
    added_.fetch_add(1, std::memory_order_release);
  }
  void part_begins() const {
    (void)added_.load(std::memory_order_acquire);
  }
  void part_ends() {
    ended_.fetch_add(1, std::memory_order_release);
  }
  void all_ended() const {
    (void)ended_.load(std::memory_order_acquire);
  }

 private:
  std::atomic<int> added_{0}, ended_{0};
#else
  void part_added() {}
  void part_begins() const {}
  void part_ends() {}
  void all_ended() const {}
#endif
};

}  // namespace

// Contexts are isolated: otherwise an exception in one task would also cancel the loops nested in its
// siblings, which would then continue although part of their ranges was skipped. Loops and groups of tasks
// are isolated: a thread that waits for one must not start unrelated work, which might need a lock or the
// memory that the thread uses. A thread that waits for steps outside of loops and locks uses neither: it
// takes any work, as otherwise its core would do nothing until the longest step has finished.

void run_parallel_for(std::size_t count, std::size_t grain, const RangeBody& body) {
  // One part: there is nothing to share, and calls for single points have several such loops.
  if (count <= grain) {
    if (count == 0) return;
    const Alone alone;
    poll();
    return body(0, count);
  }
  tbb::task_group_context context(tbb::task_group_context::isolated);
  Order order;
  order.part_added();
  const CancelToken token = cancel_token();
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, grain),
        [&](const tbb::blocked_range<std::size_t>& range) {
          order.part_begins();
          const CancelBy by(token);
          const Alone alone;
          poll();
          body(range.begin(), range.end());
          order.part_ends();
        },
        tbb::simple_partitioner(), context);
  });
  order.all_ended();
}

void parallel_steps(std::size_t count, const std::function<void(std::size_t)>& step) {
  tbb::task_group_context context(tbb::task_group_context::isolated);
  Order order;
  order.part_added();
  const auto run = [&, token = cancel_token(), is_alone = Alone::is_alone()] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          order.part_begins();
          const CancelBy by(token);
          const Alone alone(is_alone);
          poll();
          step(range.begin());
          order.part_ends();
        },
        tbb::simple_partitioner(), context);
  };
  if (Alone::is_alone())
    tbb::this_task_arena::isolate(run);
  else
    run();
  order.all_ended();
}

namespace {

class TaskGroup final : public Tasks {
 public:
  explicit TaskGroup(tbb::task_group_context& context) : group_(context) {}
  void add(std::function<void()> task) override {
    order_.part_added();
    group_.run([this, task = std::move(task)] {
      order_.part_begins();
      const CancelBy by(token_);
      const Alone alone;
      poll();
      task();
      order_.part_ends();
    });
  }
  void wait() {
    group_.wait();
    order_.all_ended();
  }

 private:
  tbb::task_group group_;
  const CancelToken token_ = cancel_token();
  Order order_;
};

}  // namespace

void parallel_tasks(const std::function<void(Tasks& tasks)>& first) {
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::this_task_arena::isolate([&] {
    TaskGroup tasks(context);
    tasks.add([&] { first(tasks); });
    tasks.wait();
  });
}

}  // namespace sdm::core

namespace sdm {

struct ThreadLimit::Impl {
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(unsigned count)
    : impl_(new Impl{{tbb::global_control::max_allowed_parallelism,
                      count > 0 ? count : static_cast<std::size_t>(tbb::info::default_concurrency())}}) {}
ThreadLimit::~ThreadLimit() = default;

}  // namespace sdm
