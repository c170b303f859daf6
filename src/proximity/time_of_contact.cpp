#include <sdm/error.h>
#include <sdm/time_of_contact.h>

#include <cmath>
#include <new>
#include <string>

#include "core/memory.h"
#include "geometry/vec.h"
#include "proximity/motion/first_contact.h"
#include "proximity/pair/pair_answers.h"

namespace sdm {
namespace {

using motion::DividedMotion;

// Two bodies at any time of their motions.
class MovingPair {
 public:
  MovingPair(const Shape& o1, const DividedMotion& motion1, const Shape& o2, const DividedMotion& motion2)
      : motions_{&motion1, &motion2}, bodies_{shape::PosedBody(o1), shape::PosedBody(o2)} {}

  void set_time(double time) {
    for (int body = 0; body < 2; ++body) bodies_[body].set_pose(motions_[body]->at(time));
    answers_.begin(bodies_[0], bodies_[1], {.closest_faces = answers_.known().closest_faces});
  }
  double separation() { return answers_.separation().value; }
  bool colliding() { return answers_.colliding(); }

  /// What there is to know at this time.
  TimeOfContact found(double time) {
    const BoundedLength& separation = answers_.separation();
    TimeOfContact found{
        .time = time, .separation = separation.value, .faces = answers_.known().closest_faces};
    found.witness = *separation.witness;
    if (separation.value > 0) found.normal = normalized(found.witness[0] - found.witness[1]);
    return found;
  }

 private:
  std::array<const DividedMotion*, 2> motions_;
  std::array<shape::PosedBody, 2> bodies_;
  pair::PairAnswers answers_{0, std::nullopt};
};

TimeOfContact find(const Shape& o1, const DividedMotion& motion1, const Shape& o2,
                   const DividedMotion& motion2, double tolerance) {
  MovingPair pair(o1, motion1, o2, motion2);
  pair.set_time(0);
  TimeOfContact found = pair.found(0);
  const bool collide = pair.colliding();
  if (collide && found.normal) found.normal = -*found.normal;
  found.contact = collide || found.separation <= tolerance;
  if (found.contact) return found;
  if (motion1.rests() && motion2.rests()) {
    found.time = 1;
    return found;
  }
  const motion::FreeMotion free = motion::find_first_contact(
      {internals(o1.sites()), motion1}, {internals(o2.sites()), motion2}, tolerance, [&](double time) {
        pair.set_time(time);
        return pair.separation() <= tolerance;
      });
  pair.set_time(free.time);
  found = pair.found(free.time);
  found.contact = found.separation <= tolerance || !free.decided;
  if (found.separation > tolerance && !free.decided) found.certainty = Certainty::bounded;
  return found;
}

}  // namespace

Transform Motion::at(double time, const Shape& shape) const {
  return DividedMotion(*this, shape).at(time);
}

TimeOfContact time_of_contact(const Shape& o1, const Motion& motion1, const Shape& o2, const Motion& motion2,
                              double tolerance) {
  if (!(tolerance > 0 && std::isfinite(tolerance)))
    throw Error("a tolerance of " + std::to_string(tolerance) + " is out of range; use more than 0");
  try {
    return find(o1, DividedMotion(motion1, o1), o2, DividedMotion(motion2, o2), tolerance);
  } catch (const std::bad_alloc&) {
    throw out_of_memory("a time of contact");
  }
}

}  // namespace sdm
