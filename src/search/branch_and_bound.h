// Certified branch and bound: the largest value of a function on a set that is divided into parts.
#pragma once

#include <sdm/error.h>
#include <sdm/execution.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/cancellation.h"
#include "core/parallel.h"

namespace sdm::search {

/// The parts of a search, each with `Part::upper`, a bound on the values in it. A part is *open* while its
/// bound exceeds the largest value that is known to occur, `lower`, by more than the precision; then it is
/// *settled*, and only its bound is kept. `Found`: what the evaluation of a run of parts results in. Reuses
/// its memory.
template <class Part, class Found>
class Parts {
 public:
  /// Forgets all parts.
  void start(double lower, double precision) {
    lower_ = lower;
    precision_ = precision;
    settled_ = -kInfinity;
    forget();
  }
  void raise(double value) { lower_ = std::max(lower_, value); }
  void settle(double upper) { settled_ = std::max(settled_, upper); }
  /// Settles the part or opens it.
  void put(const Part& part) {
    if (part.upper <= enough()) return settle(part.upper);
    auto slot = static_cast<std::uint32_t>(slots_.size());
    if (free_.empty()) {
      slots_.push_back(part);
    } else {
      slot = free_.back();
      free_.pop_back();
      slots_[slot] = part;
    }
    open_.push_back({part.upper, slot});
    std::ranges::push_heap(open_);
  }

  /// How many parts are neither settled nor taken.
  [[nodiscard]] std::size_t open_count() const { return open_.size(); }
  [[nodiscard]] double lower() const { return lower_; }
  /// The largest value matters only where it may exceed this.
  [[nodiscard]] double enough() const { return lower_ + precision_; }
  /// An upper bound on the values in all parts.
  [[nodiscard]] double upper() const {
    return std::max({lower_, settled_, open_.empty() ? lower_ : open_.front().upper});
  }

 private:
  struct Open {
    double upper;
    std::uint32_t slot;  // unique, so that the order of equal bounds is that of the slots
    auto operator<=>(const Open&) const = default;
  };

  void forget() {
    open_.clear();
    slots_.clear();
    free_.clear();
  }
  Part take(std::uint32_t slot) {
    free_.push_back(slot);
    open_.pop_back();
    return slots_[slot];
  }
  template <class Policy>
  bool take_batch(Policy& policy);
  template <class Policy>
  bool take_highest(Policy& policy);

  template <class Policy, class P, class F>
  friend void branch_and_bound(Policy& policy, Parts<P, F>& parts, const Progress& progress);

  double lower_ = 0, precision_ = 0, settled_ = 0;
  std::vector<Open> open_;  // a heap, the highest bound on top
  std::vector<Part> slots_;
  std::vector<std::uint32_t> free_;
  std::vector<Part> batch_;
  std::vector<Found> found_;  // of the runs of the batch
};

/// What a policy may leave as it is. It adds
///   evaluate(std::span<Part> run, Found& found)       concurrently, may lower the bounds of the parts
///   learn(std::span<const Part> run, Found& found)    then one run after the other, may raise `lower`
///   conclude(std::span<Part> run, Found& found)       then again: puts or settles each part or its pieces
struct Policy {
  /// Together are evaluated: kLeast parts or, of more, one more than a fraction of those that stay open.
  static constexpr std::size_t kLeast = 1, kFraction = std::numeric_limits<std::size_t>::max();
  static constexpr std::size_t kRun = 1;  ///< of the parts that are evaluated one after another
  /// If more parts than kMany are open, kOfMany of those with low bounds are evaluated: depth first, so that
  /// there are hardly more.
  static constexpr std::size_t kMany = std::size_t{1} << 20, kOfMany = std::size_t{1} << 12;

  /// Lowers the bound of an open part by what has been learned since it was put. Returns whether there was
  /// anything; others may then have higher bounds.
  template <class Part>
  static bool tighten(Part& /*part*/) {
    return false;
  }
  /// Puts or settles the pieces of a part that should not be evaluated, and returns whether it is one.
  template <class Part>
  static bool expand(const Part& /*part*/) {
    return false;
  }
  /// Sorts a batch.
  template <class Part>
  static void arrange(std::span<Part> /*batch*/) {}
  /// Whether to go on. If not, open parts stay so, and count for the upper bound.
  [[nodiscard]] static bool within_budget() { return true; }
};

/// Evaluates and divides parts, those with the highest bounds first, until none is open. The order does not
/// depend on the number of threads. Polls for cancellation at each batch. Progress, of the step `parts`, is
/// that of the logarithm of the distance between the bounds.
template <class Policy, class Part, class Found>
void branch_and_bound(Policy& policy, Parts<Part, Found>& parts, const Progress& progress = {}) {
  double first_gap = 0;
  while (parts.take_batch(policy)) {
    const std::span<Part> batch = parts.batch_;
    policy.arrange(batch);
    const std::size_t runs = (batch.size() + Policy::kRun - 1) / Policy::kRun;
    if (parts.found_.size() < runs) parts.found_.resize(runs);
    const auto run = [&](std::size_t i) {
      return batch.subspan(Policy::kRun * i, std::min(Policy::kRun, batch.size() - Policy::kRun * i));
    };
    if (runs == 1) {
      poll();
      policy.evaluate(batch, parts.found_[0]);
    } else {
      parallel_for(runs, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) policy.evaluate(run(i), parts.found_[i]);
      });
    }
    for (std::size_t i = 0; i < runs; ++i) policy.learn(run(i), parts.found_[i]);
    for (std::size_t i = 0; i < runs; ++i) policy.conclude(run(i), parts.found_[i]);
    if (!progress || parts.open_.empty()) continue;
    const double precision = parts.precision_, gap = std::max(parts.upper() - parts.lower_, precision);
    if (first_gap == 0) first_gap = gap;
    const double done =
        first_gap > precision ? std::log(first_gap / gap) / std::log(first_gap / precision) : 1;
    if (!progress("parts", std::clamp(done, 0.0, 1.0))) throw Cancelled();
  }
}

/// Sets batch_, and returns whether it has parts.
template <class Part, class Found>
template <class Policy>
bool Parts<Part, Found>::take_batch(Policy& policy) {
  batch_.clear();
  constexpr std::uint32_t kStride = 64;
  Poll due(kStride);
  if (open_.size() > Policy::kMany)  // the last ones of a heap have low bounds, and its rest is a heap
    while (policy.within_budget() && batch_.size() < Policy::kOfMany)
      batch_.push_back(take(open_.back().slot));
  else
    while (!open_.empty() && policy.within_budget() &&
           batch_.size() < std::max(Policy::kLeast, open_.size() / Policy::kFraction + 1))
      if (due(); !take_highest(policy)) break;
  return !batch_.empty();
}

/// Moves the highest part to batch_ or has it divided, or finds that it can be tightened. Returns false if
/// all parts are settled.
template <class Part, class Found>
template <class Policy>
bool Parts<Part, Found>::take_highest(Policy& policy) {
  if (open_.front().upper <= enough()) {
    settle(open_.front().upper);
    forget();
    return false;
  }
  std::ranges::pop_heap(open_);
  Open& highest = open_.back();
  Part& open = slots_[highest.slot];
  if (policy.tighten(open) && open.upper > enough()) {
    highest.upper = open.upper;
    std::ranges::push_heap(open_);
    return true;
  }
  const Part part = take(highest.slot);
  if (part.upper <= enough())
    settle(part.upper);
  else if (!policy.expand(part))
    batch_.push_back(part);
  return true;
}

}  // namespace sdm::search
