// Long computations: without the GIL, with progress, cancellation and interrupts.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/execution.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <type_traits>
#include <utility>

namespace sdm::python {

namespace nb = nanobind;

/// Runs `work` on a thread of its own while this one, without the GIL, waits for it. Calls
/// progress(step, fraction), if it is not None, on this thread, and lets Python handle signals about twenty
/// times a second. If progress returns False, `work` is cancelled, and throws Cancelled; if it raises, or a
/// signal does (KeyboardInterrupt), `work` is cancelled (sdm::CancelScope), whether or not it uses the
/// progress, and the exception is raised.
void run(nb::handle progress, const std::function<void(const Progress&)>& work);

/// Runs short work on this thread, without the GIL. It is completed before Python handles a signal.
template <class Work>
auto run_short(Work work) {
  const nb::gil_scoped_release released;
  return work();
}

/// Runs work that takes long if `size`, in faces, points or texels, is large: then as run() without progress,
/// otherwise as run_short(), which a thread of its own would slow down.
template <class Work>
auto run_sized(std::size_t size, Work work) {
  constexpr std::size_t kShort = 4000;
  using Result = decltype(work());
  if (size <= kShort) return run_short(work);
  if constexpr (std::is_void_v<Result>) {
    run(nb::none(), [&](const Progress&) { work(); });
  } else {
    std::optional<Result> result;
    run(nb::none(), [&](const Progress&) { result.emplace(work()); });
    return std::move(*result);
  }
}

/// The object that run() or run_sized() makes in the memory of one of Python's, which Python destroys only
/// after the call has returned. So it is destroyed here if the call throws: by what follows in the work, or
/// by a signal that arrived while the work was finished.
template <class Object>
class InPlace {
 public:
  explicit InPlace(Object* at) : at_(at) {}
  ~InPlace() {
    if (made_) at_->~Object();
  }
  InPlace(const InPlace&) = delete;
  InPlace& operator=(const InPlace&) = delete;

  /// Makes it of the result of a function.
  template <class Make>
  Object& make(const Make& make) {
    new (at_) Object(make());
    made_ = true;
    return *at_;
  }
  /// The call returns: the object is Python's.
  void release() { made_ = false; }

 private:
  Object* at_;
  bool made_ = false;
};

/// How many calls use an object, or that one changes it. Nothing waits, so that, unlike a mutex, it may be
/// used several times by one thread, and given back by another one.
class UseCount {
 public:
  bool try_lock_shared() {
    int users = users_.load();
    while (users != kChanged)
      if (users_.compare_exchange_weak(users, users + 1)) return true;
    return false;
  }
  void unlock_shared() { --users_; }
  bool try_lock() {
    int none = 0;
    return users_.compare_exchange_strong(none, kChanged);
  }
  void unlock() { users_ = 0; }

 private:
  static constexpr int kChanged = -1;
  std::atomic<int> users_ = 0;
};
using Use = std::shared_lock<UseCount>;
using Change = std::unique_lock<UseCount>;

/// Lets several calls use an object, or one change it. A call that would have to wait for another one throws
/// sdm::Error instead, so that no callback can block itself.
class Access {
 public:
  [[nodiscard]] Use use() const;
  [[nodiscard]] Change change();

 private:
  mutable UseCount count_;
};

}  // namespace sdm::python
