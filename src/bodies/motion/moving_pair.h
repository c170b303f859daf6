// Two bodies at any time of their motions, and their first contact.
#pragma once

#include <sdm/proximity_query.h>

#include <array>
#include <atomic>
#include <optional>

#include "bodies/motion/divided_motion.h"
#include "bodies/motion/first_contact.h"
#include "bodies/pair/pair_answers.h"
#include "bodies/shape/posed_body.h"

namespace sdm::motion {

/// A body and its motion; whatever pose it has had before.
struct MovingBody {
  const shape::PosedBody& body;
  const DividedMotion& motion;
};

class MovingPair {
 public:
  /// The motions and `answers`, whose memory is reused, must outlive this object.
  MovingPair(const MovingBody& o1, const MovingBody& o2, pair::PairAnswers& answers)
      : motions_{&o1.motion, &o2.motion}, bodies_{o1.body, o2.body}, answers_(answers) {}

  /// Their first contact, if they come into contact at any time until `until`, which other threads may lower
  /// meanwhile. As time_of_contact() finds it.
  [[nodiscard]] std::optional<TimeOfContact> first_contact(double tolerance,
                                                           const std::atomic<double>& until);
  /// What there is to know at a time, as of bodies without contact.
  [[nodiscard]] TimeOfContact at(double time);

 private:
  [[nodiscard]] FreeMotion advance(double tolerance, const std::atomic<double>& until);
  [[nodiscard]] double closing_speed(bool along_normal);
  [[nodiscard]] double reach(int body) const;
  void set_time(double time);
  [[nodiscard]] TimeOfContact found(double time);

  std::array<const DividedMotion*, 2> motions_;
  std::array<shape::PosedBody, 2> bodies_;
  pair::PairAnswers& answers_;
  bool begun_ = false;  // answers_ are of this pair
};

}  // namespace sdm::motion
