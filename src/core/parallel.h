// Parallel loops and tasks. Results must not depend on how a range is divided or on the number of threads.
// All poll for cancellation (core/cancellation.h) before each range and each task, on behalf of their caller.
#pragma once

#include <sdm/execution.h>

#include <cstddef>
#include <functional>

namespace sdm::core {

/// Calls body(begin, end) for disjoint ranges of at most about `grain` that cover [0, count), on all cores
/// that ThreadLimit allows. With a progress callback, reports the fraction done, 1 at the end, and throws
/// Cancelled if the callback returns false.
template <class Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body);
void parallel_for(std::size_t count, std::size_t grain, const Progress& progress, std::string_view step,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Runs both, concurrently if a core is free. An exception from one is rethrown once the other has finished
/// or will not start; it does not cancel loops inside the other. The thread that has finished one helps with
/// the loops of the other, unless it is within a loop or Alone.
void parallel_invoke(const std::function<void()>& first, const std::function<void()>& second);
/// The same for step(0) to step(count - 1): those that have not started are skipped when one throws.
void parallel_steps(std::size_t count, const std::function<void(std::size_t)>& step);

/// While it exists, this thread starts no other work when it waits in parallel_invoke or parallel_steps: to
/// be held with every lock under which they may be called, as the other work might need the lock.
class Alone {
 public:
  explicit Alone(bool alone = true) noexcept;
  ~Alone();
  Alone(const Alone&) = delete;
  Alone& operator=(const Alone&) = delete;

  [[nodiscard]] static bool is_alone() noexcept;

 private:
  const bool outer_;
};

/// Tasks that may add further tasks.
class Tasks {
 public:
  virtual void add(std::function<void()> task) = 0;

 protected:
  ~Tasks() = default;
};

/// Runs first(tasks) and all tasks added, concurrently as cores become free. Unlike nested parallel_invoke,
/// no thread waits for one branch while there is work in another. An exception is rethrown once all tasks
/// that were started have finished.
void parallel_tasks(const std::function<void(Tasks& tasks)>& first);

/// The number of threads that parallel_for currently uses.
[[nodiscard]] unsigned thread_count();

using RangeBody = std::function<void(std::size_t begin, std::size_t end)>;
void run_parallel_for(std::size_t count, std::size_t grain, const RangeBody& body);

template <class Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
  run_parallel_for(count, grain, std::cref(body));  // a copy would allocate
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
