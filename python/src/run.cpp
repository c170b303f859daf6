#include "run.h"

#include <pthread.h>
#include <sdm/error.h>
#include <sdm/execution.h>

#include <atomic>
#include <chrono>  // IWYU pragma: keep, for its literals
#include <condition_variable>
#include <exception>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace sdm::python {
namespace {

using namespace std::chrono_literals;

// What the computing thread and the waiting one tell each other.
class Exchange {
 public:
  // Called on the computing thread. Returns false to cancel.
  bool report(std::string_view step, double fraction) {
    if (cancelled_) return false;
    std::unique_lock lock(mutex_);
    report_ = {std::string(step), fraction};
    changed_.notify_all();
    changed_.wait(lock, [&] { return !report_; });
    return !cancelled_;
  }
  void finish() {
    const std::lock_guard lock(mutex_);
    finished_ = true;
    changed_.notify_all();
  }
  [[nodiscard]] const std::atomic<bool>& cancelled() const { return cancelled_; }

  // Called on the waiting thread. Calls on_report for every report, and on_pause when there is none for a
  // while; they return false to cancel.
  template <class OnReport, class OnPause>
  void wait(OnReport on_report, OnPause on_pause) {
    std::unique_lock lock(mutex_);
    while (!finished_) {
      const bool woken = changed_.wait_for(lock, 50ms, [&] { return report_ || finished_; });
      if (woken && !report_) continue;
      const std::optional<Report> report = report_;
      lock.unlock();
      const bool go_on = cancelled_ || (report ? on_report(report->step, report->fraction) : on_pause());
      lock.lock();
      if (!go_on) cancelled_ = true;
      if (report) {
        report_.reset();
        changed_.notify_all();
      }
    }
  }

 private:
  struct Report {
    std::string step;
    double fraction;
  };
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Report> report_;
  bool finished_ = false;
  std::atomic<bool> cancelled_{false};
};

// A thread that computes for one call after the other. It is not ended with the call: what oneTBB keeps for
// each thread that has called it is not all freed when the thread ends.
class Worker {
 public:
  Worker() {
    std::thread([this] { loop(); }).detach();
  }

  void start(std::function<void()> work) {
    const std::lock_guard lock(mutex_);
    work_ = std::move(work);
    changed_.notify_all();
  }
  // Waits for the end of the work.
  void join() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !work_; });
  }

 private:
  [[noreturn]] void loop() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return static_cast<bool>(work_); });
      lock.unlock();
      work_();
      lock.lock();
      work_ = nullptr;
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> work_;
};

// The workers without work: as many as there were calls at the same time. The GIL guards them. They are never
// destroyed, as their threads wait until the process ends.
std::vector<Worker*>& idle_workers() {
  static std::vector<Worker*>* const idle = [] {
    pthread_atfork(nullptr, nullptr, [] { idle_workers().clear(); });  // the child has none of the threads
    return new std::vector<Worker*>;
  }();
  return *idle;
}

// A worker for one call.
class Computation {
 public:
  Computation() {
    std::vector<Worker*>& idle = idle_workers();
    if (idle.empty()) {
      worker_ = new Worker;
    } else {
      worker_ = idle.back();
      idle.pop_back();
    }
  }
  ~Computation() { idle_workers().push_back(worker_); }
  Computation(const Computation&) = delete;
  Computation& operator=(const Computation&) = delete;

  void start(std::function<void()> work) { worker_->start(std::move(work)); }
  void join() { worker_->join(); }

 private:
  Worker* worker_;
};

}  // namespace

void run(nb::handle progress, const std::function<void(const Progress&)>& work) {
  const bool reports = !progress.is_none();
  if (reports && PyCallable_Check(progress.ptr()) == 0) throw Error("progress must be callable, or None");
  Exchange exchange;
  std::exception_ptr failure, raised;  // of the computation, of Python
  Computation computation;
  {
    const nb::gil_scoped_release released;
    computation.start([&] {
      const CancelScope scope(exchange.cancelled());
      try {
        work([&](std::string_view step, double fraction) {
          return reports ? exchange.report(step, fraction) : !exchange.cancelled();
        });
      } catch (...) {
        failure = std::current_exception();
      }
      exchange.finish();
    });
    // Python code, whose exceptions cancel.
    const auto guarded = [&](auto call) {
      const nb::gil_scoped_acquire acquired;
      try {
        return call();
      } catch (...) {
        raised = std::current_exception();
        return false;
      }
    };
    const auto signals = [] {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      return true;
    };
    exchange.wait(
        [&](const std::string& step, double fraction) {
          return guarded([&] {
            const nb::object answer = progress(step.c_str(), fraction);
            return signals() && !answer.is(nb::handle(Py_False));
          });
        },
        [&] { return guarded(signals); });
    computation.join();
  }
  if (raised) std::rethrow_exception(raised);
  if (failure) std::rethrow_exception(failure);
}

Use Access::use() const {
  Use lock(count_, std::try_to_lock);
  if (!lock) throw Error("the object is being changed by another call; wait for its end");
  return lock;
}

Change Access::change() {
  Change lock(count_, std::try_to_lock);
  if (!lock) throw Error("the object is in use by another call; wait for its end");
  return lock;
}

}  // namespace sdm::python
