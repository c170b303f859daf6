#include "bodies/many/moving_bodies.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <tuple>

#include "bodies/many/pool.h"
#include "bodies/motion/divided_motion.h"
#include "bodies/motion/moving_pair.h"
#include "bodies/pair/pair_answers.h"
#include "core/parallel.h"

namespace sdm::bodies {
namespace {

void lower_to(std::atomic<double>& least, double value) {
  double known = least.load(std::memory_order_relaxed);
  while (value < known && !least.compare_exchange_weak(known, value, std::memory_order_relaxed)) {
  }
}

}  // namespace

std::vector<Box> MovingBodies::swept_boxes() const {
  std::vector<Box> boxes(bodies_.size());
  for (std::size_t b = 0; b < boxes.size(); ++b) boxes[b] = motion::swept_box(bodies_[b].body(), motions_[b]);
  return boxes;
}

std::vector<PairTimeOfContact> MovingBodies::first_contacts(const PairFilter& filter, double tolerance,
                                                            const TimeOfContactOptions& options) const {
  Sweep sweep;
  const std::span<const Sweep::Pair> pairs = sweep.near_pairs(swept_boxes(), tolerance, std::cref(filter));
  std::vector<std::optional<TimeOfContact>> found(pairs.size());
  std::atomic<double> until = options.until;
  Pool<pair::PairAnswers> pool;
  const auto find_some = [&](std::size_t begin, std::size_t end) {
    std::unique_ptr<pair::PairAnswers> answers =
        pool.take([] { return std::make_unique<pair::PairAnswers>(0, std::nullopt); });
    for (std::size_t i = begin; i < end; ++i) {
      const auto [a, b] = pairs[i];
      motion::MovingPair pair({bodies_[a], motions_[a]}, {bodies_[b], motions_[b]}, *answers);
      found[i] = pair.first_contact(tolerance, until);
      if (found[i] && options.earliest_only) lower_to(until, found[i]->time);
    }
    pool.give_back(std::move(answers));
  };
  parallel_for(pairs.size(), 1, find_some);

  std::vector<PairTimeOfContact> contacts;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (found[i] && found[i]->time <= until) contacts.push_back({pairs[i][0], pairs[i][1], *found[i]});
  std::ranges::sort(contacts, {}, [](const PairTimeOfContact& c) {
    return std::tuple(c.time_of_contact.time, c.first, c.second);
  });
  return contacts;
}

}  // namespace sdm::bodies
