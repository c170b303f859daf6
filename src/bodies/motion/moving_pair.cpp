#include "bodies/motion/moving_pair.h"

#include "bodies/motion/first_contact.h"
#include "geometry/vec.h"

namespace sdm::motion {

void MovingPair::set_time(double time) {
  for (int body = 0; body < 2; ++body) bodies_[body].set_pose(motions_[body]->at(time));
  const pair::Hints hints = begun_ ? answers_.known().hints() : pair::Hints{};
  answers_.begin(bodies_[0], bodies_[1], hints);
  begun_ = true;
}

TimeOfContact MovingPair::found(double time) {
  const BoundedLength& separation = answers_.separation();
  TimeOfContact found{.time = time, .separation = separation.value, .faces = answers_.known().closest_faces};
  found.witness = *separation.witness;
  if (separation.value > 0) found.normal = normalized(found.witness[0] - found.witness[1]);
  return found;
}

TimeOfContact MovingPair::at(double time) {
  set_time(time);
  return found(time);
}

std::optional<TimeOfContact> MovingPair::first_contact(double tolerance, const std::atomic<double>& until) {
  set_time(0);
  if (answers_.within(tolerance)) {
    const bool collide = answers_.colliding();
    TimeOfContact contact = found(0);
    if (collide && contact.normal) contact.normal = -*contact.normal;
    contact.contact = true;
    return contact;
  }
  if (motions_[0]->rests() && motions_[1]->rests()) return std::nullopt;
  const auto surface = [&](int body) {
    return MovingSurface{internals(bodies_[body].body().sites()), *motions_[body]};
  };
  const auto in_contact = [&](double time) {
    set_time(time);
    return answers_.separation().value <= tolerance;
  };
  const FreeMotion free = find_first_contact(surface(0), surface(1), tolerance, in_contact, &until);
  if (free.time > until.load(std::memory_order_relaxed)) return std::nullopt;
  set_time(free.time);
  if (free.decided && !answers_.surfaces_within(tolerance)) return std::nullopt;
  TimeOfContact contact = found(free.time);
  contact.contact = true;
  if (contact.separation > tolerance) contact.certainty = Certainty::bounded;
  return contact;
}

}  // namespace sdm::motion
