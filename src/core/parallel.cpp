#include "core/parallel.h"

#include <sdm/error.h>
#include <sdm/threads.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <atomic>
#include <mutex>

namespace sdm {

struct ThreadLimit::Impl {
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(unsigned count)
    : impl_(new Impl{{tbb::global_control::max_allowed_parallelism,
                      count > 0 ? count : static_cast<std::size_t>(tbb::info::default_concurrency())}}) {}
ThreadLimit::~ThreadLimit() = default;

unsigned thread_count() {
  return static_cast<unsigned>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, grain),
      [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); },
      tbb::simple_partitioner());
}

void parallel_for(std::size_t count, std::size_t grain, const Progress& progress, std::string_view step,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  if (!progress) return parallel_for(count, grain, body);
  std::atomic<std::size_t> done{0};
  std::atomic<bool> cancelled{false};
  std::mutex reporting;
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    if (cancelled.load(std::memory_order_relaxed)) return;
    body(begin, end);
    done += end - begin;
    // Who finds another thread reporting goes on working: the next report tells its share too.
    if (std::unique_lock lock(reporting, std::try_to_lock); lock.owns_lock())
      if (!progress(step, static_cast<double>(done.load()) / static_cast<double>(count))) cancelled = true;
  });
  if (cancelled) throw Cancelled();
}

void parallel_invoke(const std::function<void()>& first, const std::function<void()>& second) {
  tbb::parallel_invoke(first, second);
}

}  // namespace sdm
