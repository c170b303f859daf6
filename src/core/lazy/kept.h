// A value that is derived from an object and kept with it, made when it is first needed.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <utility>

#include "core/parallel.h"

namespace sdm::core {

/// The first call of get() makes the value, while concurrent calls of it wait. If that throws, nothing is
/// kept, and a later call tries again. `Value` may be incomplete where it is only stored.
template <class Value>
class Kept {
 public:
  Kept() = default;
  ~Kept() = default;
  // No call of get() may run beside these.
  Kept(Kept&& other) noexcept { *this = std::move(other); }
  Kept& operator=(Kept&& other) noexcept {
    value_ = std::move(other.value_);
    ready_.store(other.ready_.exchange(nullptr));
    return *this;
  }
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;

  /// The value, which is valid until forget() or outdate(). make() returns a std::shared_ptr to it, and may
  /// run parallel loops: a thread that makes a value never waits for itself.
  template <class Make>
  const Value& get(const Make& make) const {
    return get(make, [&](Value&) { value_ = make(); });
  }
  /// The same; after outdate(), renew(value) makes the value again in the memory that it has.
  template <class Make, class Renew>
  const Value& get(const Make& make, const Renew& renew) const {
    if (const Value* const ready = ready_.load(std::memory_order_acquire)) return *ready;
    const std::lock_guard lock(making_);
    const Alone alone;
    if (ready_.load(std::memory_order_relaxed) == nullptr) {
      if (value_)
        renew(*value_);
      else
        value_ = make();
      ready_.store(value_.get(), std::memory_order_release);
    }
    return *value_;
  }
  // Neither may run beside get().
  /// The value is to be renewed.
  void outdate() noexcept { ready_.store(nullptr); }
  /// There is no value.
  void forget() noexcept {
    ready_.store(nullptr);
    value_.reset();
  }

 private:
  mutable std::mutex making_;
  mutable std::shared_ptr<Value> value_;
  mutable std::atomic<const Value*> ready_ = nullptr;
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
