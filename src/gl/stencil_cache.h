// The paper's stencil cache (4.1): assigns the few values of the stencil buffer to faces.
#pragma once

#include <cstdint>
#include <list>
#include <unordered_map>

namespace sdm::gl {

/// Values 1 ... K, of which the least recently used is reassigned. Independent of OpenGL.
class StencilCache {
 public:
  static constexpr std::uint32_t kNobody = 0xFFFFFFFFu;

  struct Use {
    int value = 0;
    bool hit = false;                 ///< the face's texels already have the value
    std::uint32_t evicted = kNobody;  ///< the face that has lost the value; its texels must be cleared first
  };

  explicit StencilCache(int values) : values_(values) {}

  /// Returns the value of a face, assigning one if necessary. Cost: constant.
  Use use(std::uint32_t face) {
    ++lookups_;
    if (const auto found = entries_.find(face); found != entries_.end()) {
      ++hits_;
      recent_.splice(recent_.begin(), recent_, found->second);
      return {found->second->value, true, kNobody};
    }
    Use use;
    if (static_cast<int>(recent_.size()) < values_) {
      use.value = static_cast<int>(recent_.size()) + 1;
    } else {
      ++evictions_;
      use.value = recent_.back().value;
      use.evicted = recent_.back().face;
      entries_.erase(recent_.back().face);
      recent_.pop_back();
    }
    recent_.push_front({face, use.value});
    entries_[face] = recent_.begin();
    return use;
  }

  [[nodiscard]] std::uint64_t lookups() const { return lookups_; }
  [[nodiscard]] std::uint64_t hits() const { return hits_; }
  [[nodiscard]] std::uint64_t evictions() const { return evictions_; }

 private:
  struct Entry {
    std::uint32_t face;
    int value;
  };
  int values_;
  std::list<Entry> recent_;  ///< most recently used first
  std::unordered_map<std::uint32_t, std::list<Entry>::iterator> entries_;
  std::uint64_t lookups_ = 0, hits_ = 0, evictions_ = 0;
};

}  // namespace sdm::gl
