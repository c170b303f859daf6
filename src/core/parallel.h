// The one way to use several cores. Bodies must not depend on how the range is cut or on the number of
// threads.
#pragma once

#include <sdm/progress.h>

#include <cstddef>
#include <functional>

namespace sdm::core {

/// Calls body(begin, end) for disjoint ranges that cover [0, count), of about `grain` or less, on all cores
/// allowed. With a progress callback, reports the fraction done, 1 at the end, and throws Cancelled when it
/// says so.
template <class Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body);
void parallel_for(std::size_t count, std::size_t grain, const Progress& progress, std::string_view step,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Runs both, at the same time where a core is free. An exception of one comes out after the other is done or
/// was not begun; it never cuts loops within the other short.
void parallel_invoke(const std::function<void()>& first, const std::function<void()>& second);

/// Work that adds to itself.
class Tasks {
 public:
  virtual void add(std::function<void()> task) = 0;

 protected:
  ~Tasks() = default;
};

/// Runs first(tasks) and all that is added to the tasks, at the same time where cores are free; unlike nested
/// calls of parallel_invoke, without threads that wait for one branch while there is work in another. An
/// exception comes out after those that were begun are done.
void parallel_tasks(const std::function<void(Tasks& tasks)>& first);

/// Threads that parallel_for uses now.
[[nodiscard]] unsigned thread_count();

using RangeBody = std::function<void(std::size_t begin, std::size_t end)>;
void run_parallel_for(std::size_t count, std::size_t grain, const RangeBody& body);

template <class Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
  run_parallel_for(count, grain, std::cref(body));  // a reference takes no memory, as a copy would
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // the vocabulary of every folder
}
