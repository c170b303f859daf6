#include "bodies/motion/moving_pair.h"

#include <algorithm>

#include "core/cancellation.h"
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
  if (separation.witness) found.witness = *separation.witness;
  if (separation.value > 0 && separation.witness)
    found.normal = normalized(found.witness[0] - found.witness[1]);
  return found;
}

// The largest distance of a point of a body from the centre of its motion; of a half-space, of a point of the
// other body from that centre.
double MovingPair::reach(int body) const {
  const shape::Body& of = bodies_[body].body();
  const DividedMotion& motion = *motions_[body];
  if (!of.half_space()) return motion.scale() * (norm(of.ball().centre - motion.middle()) + of.ball().radius);
  const DividedMotion& other = *motions_[1 - body];
  const Vec3 first = other.start() - motion.start(), last = first + other.shift() - motion.shift();
  return std::max(norm(first), norm(last)) + reach(1 - body);
}

// How fast the bodies can approach each other from now on, at most: any two points, or their extents along
// the normal, if a plane across it separates them. The velocity of a point at q from the centre is w × q, no
// more than |n × w| |q| along n.
double MovingPair::closing_speed(bool along_normal) {
  const Vec3 shift = motions_[0]->shift() - motions_[1]->shift();
  const Vec3 n = along_normal ? answers_.relation().normal : Vec3{};
  double speed = along_normal ? -dot(n, shift) : norm(shift);
  for (int body = 0; body < 2; ++body) {
    const DividedMotion& motion = *motions_[body];
    if (!motion.turns()) continue;
    if (along_normal && bodies_[body].body().half_space()) return kInfinity;
    const double across = along_normal ? norm(cross(n, motion.axis())) : 1;
    speed += motion.angle() * across * reach(body);
  }
  return speed;
}

// Conservative advancement of the bodies as a whole, until they are within the tolerance.
FreeMotion MovingPair::advance(double tolerance, const std::atomic<double>& until) {
  constexpr std::uint32_t kMostSteps = 1'000'000;
  double time = 0;
  Poll due(256);
  for (std::uint32_t step = 0; step < kMostSteps; ++step) {
    due();
    const double apart = answers_.separation().lower;
    if (apart <= tolerance) return {.time = time};
    if (time > until.load(std::memory_order_relaxed)) return {};
    double speed = closing_speed(false);
    if (const solids::Relation& relation = answers_.relation(); relation.signed_distance && relation.gap > 0)
      speed = std::min(speed, closing_speed(true));
    if (!(speed > 0)) return {};
    const double next = time + (apart - 0.5 * tolerance) / speed;
    if (!(next < 1)) return {};
    if (!(next > time)) break;
    time = next;
    set_time(time);
  }
  return {.time = time, .decided = false};
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
  const bool solids = solids::are_solid_pair(bodies_[0], bodies_[1]);
  const FreeMotion free = solids ? advance(tolerance, until)
                                 : find_first_contact(surface(0), surface(1), tolerance, in_contact, &until);
  if (free.time > until.load(std::memory_order_relaxed)) return std::nullopt;
  set_time(free.time);
  if (free.decided && !answers_.surfaces_within(tolerance)) return std::nullopt;
  TimeOfContact contact = found(free.time);
  contact.contact = true;
  if (contact.separation > tolerance) contact.certainty = Certainty::bounded;
  return contact;
}

}  // namespace sdm::motion
