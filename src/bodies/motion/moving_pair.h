// Two bodies at any time of their motions, and their first contact.
#pragma once

#include <sdm/proximity_query.h>

#include <array>
#include <atomic>
#include <functional>
#include <optional>

#include "bodies/motion/divided_motion.h"
#include "bodies/motion/parts.h"
#include "bodies/pair/pair_answers.h"
#include "bodies/shape/posed_body.h"

namespace sdm::motion {

/// Until when the motions are free.
struct FreeMotion {
  double time = 1;
  bool decided = true;  ///< false: they could not be continued, by rounding, though there is no contact
};

/// Finds until when two surfaces move freely, provided that they are more than the tolerance apart at time 0:
/// until then, they are more than half of the tolerance apart. Ends before time 1 where faces are within the
/// tolerance and in_contact(time) agrees, or where neither can be decided. Returns a motion that is free
/// where that is later than `until`, if given, which other threads may lower meanwhile.
///
/// Controlled conservative advancement (Tang, Kim & Manocha 2009), of each pair of nodes and faces by itself:
/// each has a time until which it is safe, those with the least are advanced or divided next. Cost: that of
/// the pairs of nodes that come near each other before that time; memory for those that are open at once.
[[nodiscard]] FreeMotion find_first_contact(const MovingSurface& o1, const MovingSurface& o2,
                                            double tolerance, const std::function<bool(double)>& in_contact,
                                            const std::atomic<double>* until = nullptr);

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
  /// The distance and the closest points at a time, as of bodies without contact.
  [[nodiscard]] TimeOfContact at(double time);

 private:
  [[nodiscard]] FreeMotion advance(double tolerance, const std::atomic<double>& until);
  [[nodiscard]] double closing_speed(bool along_normal);
  [[nodiscard]] double from_centre(int body) const;
  void set_time(double time);
  [[nodiscard]] TimeOfContact found(double time);

  std::array<const DividedMotion*, 2> motions_;
  std::array<shape::PosedBody, 2> bodies_;
  pair::PairAnswers& answers_;
  bool begun_ = false;  // answers_ are of this pair
};

}  // namespace sdm::motion
