#include "bodies/many/near_pairs.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "core/memory.h"

namespace sdm::bodies {
namespace {

// Up to this many bodies that have moved, comparing the box of each with those of all others takes less time
// than a sweep, whatever the number of bodies: both are proportional to it, or nearly so.
constexpr std::size_t kFewMoved = 64;

}  // namespace

void PairFilter::exclude(const Sweep::Pair& pair) {
  const auto at = std::ranges::lower_bound(excluded_, pair);
  if (at == excluded_.end() || *at != pair) excluded_.insert(at, pair);
}

void PairFilter::include(const Sweep::Pair& pair) {
  const auto [first, last] = std::ranges::equal_range(excluded_, pair);
  excluded_.erase(first, last);
}

bool PairFilter::operator()(std::uint32_t a, std::uint32_t b) const {
  const BodyFilter &of_a = of_[a], &of_b = of_[b];
  if ((of_a.fixed && of_b.fixed) || (of_a.groups & of_b.mask) == 0 || (of_b.groups & of_a.mask) == 0)
    return false;
  if (half_space_[a] != 0 && half_space_[b] != 0) return false;
  const auto [first, second] = std::minmax(body_of_[a], body_of_[b]);
  return first != second &&
         (excluded_.empty() || !std::ranges::binary_search(excluded_, Sweep::Pair{first, second}));
}

MovedBodies::MovedBodies(std::size_t bodies) : flags_(bodies, 0) {
  list_.reserve(bodies);
  for (std::size_t body = 0; body < bodies; ++body) add(body);
}

void MovedBodies::clear() noexcept {
  for (const std::uint32_t body : list_) flags_[body] = 0;
  list_.clear();
}

void NearPairs::moved(std::size_t body) noexcept {
  if (moved_.list().empty()) max_gap_.before = std::exchange(max_gap_.since_motion, 0);
  moved_.add(body);
  surroundings_ += filter_[body].fixed;
}

void NearPairs::follow(std::span<const shape::PosedBody> bodies, double max_gap) try {
  max_gap_.since_motion = std::max(max_gap_.since_motion, max_gap);
  const double needed = std::max(max_gap_.since_motion, max_gap_.before);
  if (complete_ && moved_.list().empty() && needed <= max_gap_.listed) return;
  for (const std::uint32_t body : moved_.list()) boxes_[body] = bodies[body].tight_box();
  if (!complete_ || needed > max_gap_.listed || moved_.list().size() > kFewMoved)
    adopt(sweep_.near_pairs(boxes_, needed, std::cref(filter_)));
  else {
    find_near_moved(needed);
    adopt(found_);
  }
  moved_.clear();
  max_gap_.listed = needed;
  complete_ = true;
} catch (...) {
  forget();
  throw;
}

// The pairs of the list without a body that has moved, and those of the bodies that have.
void NearPairs::find_near_moved(double max_gap) {
  near_moved_.clear();
  for (const std::uint32_t a : moved_.list())
    for (std::uint32_t b = 0; b < boxes_.size(); ++b) {
      if (a == b || (b < a && moved_.contains(b))) continue;
      if (box_distance(boxes_[a], boxes_[b]) <= max_gap && filter_(a, b))
        near_moved_.push_back({std::min(a, b), std::max(a, b)});
    }
  std::ranges::sort(near_moved_);
  found_.clear();
  auto next = near_moved_.begin();
  for (const NearPair& listed : list_) {
    if (listed.gap > max_gap || moved_.any_of(listed.pair)) continue;
    for (; next != near_moved_.end() && *next < listed.pair; ++next) found_.push_back(*next);
    found_.push_back(listed.pair);
  }
  found_.insert(found_.end(), next, near_moved_.end());
}

// Makes a list of the pairs that were found, with the states of those listed before.
void NearPairs::adopt(std::span<const Sweep::Pair> found) {
  next_.clear();
  // Whatever way pairs are found next time, there is room for as many.
  const std::size_t most = std::max(found.size(), list_.size());
  reserve_for(next_, most);
  reserve_for(near_moved_, most);
  if (found.data() != found_.data()) reserve_for(found_, most);
  auto before = list_.begin();
  const auto drop_until = [&](const auto& reached) {
    for (; before != list_.end() && !reached(before->pair); ++before) unused_.push_back(before->state);
  };
  for (const Sweep::Pair& pair : found) {
    drop_until([&](const Sweep::Pair& other) { return other >= pair; });
    const bool listed = before != list_.end() && before->pair == pair;
    if (listed && !moved_.any_of(pair)) {
      next_.push_back(*before++);
      continue;
    }
    const pair::Hints hints = listed ? states_[before->state].known.hints() : pair::Hints{};
    const std::uint32_t state = listed ? (before++)->state : new_state();
    states_[state] = {};
    states_[state].known.forget(hints);
    next_.push_back({.pair = pair, .state = state, .gap = box_distance(boxes_[pair[0]], boxes_[pair[1]])});
  }
  drop_until([](const Sweep::Pair&) { return false; });
  std::swap(list_, next_);
}

std::uint32_t NearPairs::new_state() {
  if (unused_.empty()) {
    states_.emplace_back();
    reserve_for(unused_, states_.size());  // all may become unused
    return static_cast<std::uint32_t>(states_.size() - 1);
  }
  const std::uint32_t state = unused_.back();
  unused_.pop_back();
  return state;
}

void NearPairs::forget() noexcept {
  list_.clear();
  states_.clear();
  unused_.clear();
  complete_ = false;
}

}  // namespace sdm::bodies
