#include <sdm/proximity_query.h>

#include <new>
#include <optional>

#include "bodies/motion/moving_pair.h"
#include "core/memory.h"

namespace sdm {
namespace {

using motion::DividedMotion;

TimeOfContact find(const Shape& o1, const DividedMotion& motion1, const Shape& o2,
                   const DividedMotion& motion2, double tolerance) {
  const shape::PosedBody body1(o1), body2(o2);
  pair::PairAnswers answers(0, std::nullopt);
  motion::MovingPair pair({body1, motion1}, {body2, motion2}, answers);
  const std::optional<TimeOfContact> contact = pair.first_contact(tolerance, 1);
  return contact ? *contact : pair.at(1);
}

}  // namespace

Transform Motion::at(double time, const Shape& shape) const {
  return DividedMotion(*this, shape).at(time);
}

TimeOfContact time_of_contact(const Shape& o1, const Motion& motion1, const Shape& o2, const Motion& motion2,
                              double tolerance) {
  motion::check_tolerance(tolerance);
  try {
    return find(o1, DividedMotion(motion1, o1), o2, DividedMotion(motion2, o2), tolerance);
  } catch (const std::bad_alloc&) {
    throw out_of_memory("a time of contact");
  }
}

}  // namespace sdm
