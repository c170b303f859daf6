// The loops of core/parallel.h on std::thread, for platforms without oneTBB.
//
// A job is a loop or a group of tasks. Its caller works on it until no part is left to begin, and then, until
// the parts that workers have begun are done, on the jobs within these; it does no other work meanwhile,
// which might need a lock that it holds. Idle workers join the job that was added last. A part waits only for
// parts that threads are working on, so that nothing waits in a circle.
#include <sdm/execution.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "core/cancellation.h"
#include "core/parallel.h"

namespace sdm::core {

namespace {

constexpr unsigned kMostThreads = 256;

unsigned processors() {
  return std::clamp(std::thread::hardware_concurrency(), 1u, kMostThreads);
}

class Job {
 public:
  virtual ~Job() = default;
  [[nodiscard]] virtual bool has_parts() const = 0;  ///< that no thread has begun
  virtual void work() = 0;                           ///< on its parts until none is left to begin
  virtual void drop_parts() = 0;

  /// Whether it was begun by a part of another job, or by a part of a job within that.
  [[nodiscard]] bool is_within(const Job& other) const {
    const Job* outer = outer_;
    while (outer && outer != &other) outer = outer->outer_;
    return outer != nullptr;
  }

  const CancelToken token = cancel_token();
  int threads = 0;           ///< that work on it; guarded by the pool
  std::exception_ptr error;  ///< the first one; guarded by the pool

 private:
  friend class Part;
  static thread_local Job* current_;  ///< whose part this thread works on
  Job* const outer_ = current_;
};

thread_local Job* Job::current_ = nullptr;

/// This thread works on a part of a job.
class Part {
 public:
  explicit Part(Job& job) : outer_(std::exchange(Job::current_, &job)) {}
  ~Part() { Job::current_ = outer_; }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;

 private:
  Job* const outer_;
};

class Pool {
 public:
  /// Its threads are not joined: they wait for work until the process ends, so that it is not destroyed.
  static Pool& instance() {
    static Pool& pool = *new Pool;
    return pool;
  }

  void run(Job& job) {
    std::unique_lock lock(mutex_);
    jobs_.push_back(&job);
    // The caller's job does not outlive this call: no exception leaves before its threads have.
    wake();
    if (waiting_ > 0) changed_.notify_all();
    ++waiting_;
    for (;;) {
      Job* within = nullptr;
      changed_.wait(lock, [&] { return job.threads == 0 || job.has_parts() || (within = job_within(job)); });
      if (job.has_parts())
        work_on(job, lock);
      else if (job.threads == 0)
        break;
      else
        work_on(*within, lock);
    }
    --waiting_;
    std::erase(jobs_, &job);
    if (job.error) std::rethrow_exception(job.error);
  }

  /// Must be called after a part of a job has added another part to it.
  void part_added() {
    const std::lock_guard lock(mutex_);
    wake();
    changed_.notify_all();
  }

  [[nodiscard]] unsigned limit() {
    const std::lock_guard lock(mutex_);
    return limit_now();
  }
  std::multiset<unsigned>::iterator add_limit(unsigned count) {
    const std::lock_guard lock(mutex_);
    return limits_.insert(count > 0 ? std::min(count, kMostThreads) : processors());
  }
  void remove_limit(std::multiset<unsigned>::iterator limit) {
    const std::lock_guard lock(mutex_);
    limits_.erase(limit);
  }

 private:
  [[nodiscard]] unsigned limit_now() const { return limits_.empty() ? processors() : *limits_.begin(); }
  /// The callers are not counted, but for one.
  [[nodiscard]] bool may_join() const { return busy_ + 1 < limit_now(); }

  /// Begins and ends with the lock held.
  void work_on(Job& job, std::unique_lock<std::mutex>& lock) noexcept {
    ++job.threads;
    lock.unlock();
    std::exception_ptr error;
    try {
      const CancelBy by(job.token);
      const Part part(job);
      job.work();
    } catch (...) {
      error = std::current_exception();
      job.drop_parts();
    }
    lock.lock();
    if (error && !job.error) job.error = std::move(error);
    if (--job.threads == 0) changed_.notify_all();
  }

  template <class Accept>
  [[nodiscard]] Job* last_job(const Accept& accept) const {
    const auto job = std::find_if(jobs_.rbegin(), jobs_.rend(), accept);
    return job == jobs_.rend() ? nullptr : *job;
  }
  [[nodiscard]] Job* job_with_parts() const {
    return last_job([](const Job* job) { return job->has_parts(); });
  }
  [[nodiscard]] Job* job_within(const Job& outer) const {
    return last_job([&](const Job* job) { return job->has_parts() && job->is_within(outer); });
  }

  void wait_for_jobs() {
    std::unique_lock lock(mutex_);
    for (;;) {
      Job* job = nullptr;
      added_.wait(lock, [&] { return may_join() && (job = job_with_parts()) != nullptr; });
      ++busy_;
      work_on(*job, lock);
      --busy_;
    }
  }

  void wake() noexcept {
    try {
      for (; workers_ + 1 < limit_now(); ++workers_) std::thread([this] { wait_for_jobs(); }).detach();
    } catch (const std::exception&) {
      // Those that there are do the work.
    }
    if (may_join()) added_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable added_, changed_;
  std::vector<Job*> jobs_;  ///< those that run, in the order of their beginnings
  std::multiset<unsigned> limits_;
  unsigned workers_ = 0, busy_ = 0, waiting_ = 0;
};

class Loop final : public Job {
 public:
  Loop(std::size_t count, std::size_t grain, const RangeBody& body)
      : count_(count), grain_(grain), body_(body) {}
  [[nodiscard]] bool has_parts() const override { return next_ < count_; }
  void work() override {
    for (;;) {
      std::size_t begin = next_;
      while (begin < count_ && !next_.compare_exchange_weak(begin, begin + std::min(grain_, count_ - begin)))
        continue;
      if (begin >= count_) return;
      poll();
      body_(begin, begin + std::min(grain_, count_ - begin));
    }
  }
  void drop_parts() override { next_ = count_; }

 private:
  const std::size_t count_, grain_;
  const RangeBody& body_;
  std::atomic<std::size_t> next_{0};
};

class TaskGroup final : public Job, public Tasks {
 public:
  [[nodiscard]] bool has_parts() const override {
    const std::lock_guard lock(mutex_);
    return !tasks_.empty();
  }
  void work() override {
    while (const std::function<void()> task = take()) {
      poll();
      task();
    }
  }
  void drop_parts() override {
    const std::lock_guard lock(mutex_);
    dropped_ = true;
    tasks_.clear();
  }
  void add(std::function<void()> task) override {
    {
      const std::lock_guard lock(mutex_);
      if (dropped_) return;
      tasks_.push_back(std::move(task));
    }
    Pool::instance().part_added();
  }

 private:
  std::function<void()> take() {
    const std::lock_guard lock(mutex_);
    if (tasks_.empty()) return {};
    std::function<void()> task = std::move(tasks_.front());
    tasks_.pop_front();
    return task;
  }

  mutable std::mutex mutex_;
  std::deque<std::function<void()>> tasks_;
  bool dropped_ = false;
};

}  // namespace

unsigned thread_count() {
  return Pool::instance().limit();
}

void run_parallel_for(std::size_t count, std::size_t grain, const RangeBody& body) {
  Loop loop(count, std::max<std::size_t>(1, grain), body);
  // One part, or one thread: there is nothing to share.
  if (count <= grain || thread_count() == 1) return loop.work();
  Pool::instance().run(loop);
}

void parallel_steps(std::size_t count, const std::function<void(std::size_t)>& step) {
  run_parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) step(i);
  });
}

void parallel_tasks(const std::function<void(Tasks& tasks)>& first) {
  TaskGroup group;
  group.add([&] { first(group); });
  Pool::instance().run(group);
}

}  // namespace sdm::core

namespace sdm {

struct ThreadLimit::Impl {
  std::multiset<unsigned>::iterator limit;
};

ThreadLimit::ThreadLimit(unsigned count) : impl_(new Impl{core::Pool::instance().add_limit(count)}) {}
ThreadLimit::~ThreadLimit() {
  core::Pool::instance().remove_limit(impl_->limit);
}

}  // namespace sdm
