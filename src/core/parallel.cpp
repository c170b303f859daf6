#include "core/parallel.h"

#include <sdm/error.h>
#include <sdm/execution.h>

#include <atomic>
#include <mutex>
#include <utility>

#include "core/cancellation.h"

namespace sdm::core {

namespace {

thread_local bool alone_now = false;

}  // namespace

Alone::Alone(bool alone) noexcept : outer_(std::exchange(alone_now, alone)) {}
Alone::~Alone() {
  alone_now = outer_;
}
bool Alone::is_alone() noexcept {
  return alone_now;
}

void parallel_invoke(const std::function<void()>& first, const std::function<void()>& second) {
  parallel_steps(2, [&](std::size_t i) { i == 0 ? first() : second(); });
}

void parallel_for(std::size_t count, std::size_t grain, const Progress& progress, std::string_view step,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  if (!progress) return parallel_for(count, grain, body);
  std::atomic<std::size_t> done{0};
  std::atomic<bool> cancelled{false};
  CancelToken token = cancel_token();
  token.progress = &cancelled;
  const CancelBy by(token);
  std::mutex reporting;
#ifdef __wasm__
  // JavaScript's callback exists in the thread that calls, which works on every loop.
  const auto caller = std::this_thread::get_id();
  const auto may_report = [caller] { return std::this_thread::get_id() == caller; };
#else
  const auto may_report = [] { return true; };
#endif
  std::size_t reported = 0;
  const auto report = [&] {
    reported = done.load();
    if (!progress(step, static_cast<double>(reported) / static_cast<double>(count))) cancelled = true;
  };
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    body(begin, end);
    done += end - begin;
    // A thread that finds another one reporting continues: the next report includes its share.
    if (!may_report()) return;
    if (std::unique_lock lock(reporting, std::try_to_lock); lock.owns_lock()) report();
  });
  // The last thread to finish may have been one of those.
  if (!cancelled && reported < count) report();
  if (cancelled) throw Cancelled();
}

}  // namespace sdm::core

namespace sdm {

void run_concurrently(const std::vector<std::function<void()>>& tasks) {
  parallel_steps(tasks.size(), [&](std::size_t i) { tasks[i](); });
}

}  // namespace sdm
