// A queue that returns items roughly in the order of their priorities.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

namespace sdm::atlas {

/// Items whose priorities, ≥ 0, fall into the same interval of `width` are returned in the order in which
/// they were pushed. Priorities must not be below the last interval returned from. Cost: constant, other than
/// the logarithm of a heap.
template <class Item>
class BucketQueue {
 public:
  explicit BucketQueue(double width) : width_(width) {}

  void push(double priority, const Item& item) {
    const double bucket = std::min(priority / width_, kMostBuckets - 1.0);
    const std::size_t b = bucket > static_cast<double>(bucket_) ? static_cast<std::size_t>(bucket) : bucket_;
    if (b >= buckets_.size()) buckets_.resize(b + 1);
    buckets_[b].push_back(item);
  }
  std::optional<Item> pop() {
    while (bucket_ < buckets_.size() && next_ == buckets_[bucket_].size()) {
      buckets_[bucket_++] = {};
      next_ = 0;
    }
    if (bucket_ == buckets_.size()) return std::nullopt;
    return buckets_[bucket_][next_++];
  }
  /// The item that will be returned after `count` others, if it is known by now.
  [[nodiscard]] const Item* ahead(std::size_t count) const {
    return bucket_ < buckets_.size() && next_ + count < buckets_[bucket_].size()
               ? &buckets_[bucket_][next_ + count]
               : nullptr;
  }

 private:
  static constexpr std::size_t kMostBuckets = 1 << 20;  // the last one takes all larger priorities

  double width_;
  std::vector<std::vector<Item>> buckets_;
  std::size_t bucket_ = 0, next_ = 0;  ///< of the next item
};

}  // namespace sdm::atlas
