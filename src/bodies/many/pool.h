// Objects that threads take one at a time and give back.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace sdm::bodies {

/// The memory of concurrent work: one object for each thread that has been at work at the same time.
template <class Object>
class Pool {
 public:
  /// One that was given back, or else make(), which returns a std::unique_ptr.
  template <class Make>
  [[nodiscard]] std::unique_ptr<Object> take(const Make& make) {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return make();
    std::unique_ptr<Object> object = std::move(idle_.back());
    idle_.pop_back();
    return object;
  }
  void give_back(std::unique_ptr<Object> object) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(object));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Object>> idle_;
};

}  // namespace sdm::bodies
