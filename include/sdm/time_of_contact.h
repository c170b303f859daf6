/// When two bodies that move from one pose to another first come into contact.
///
/// Threads: the functions may be called concurrently, also with the same shapes.
#pragma once

#include <sdm/api.h>
#include <sdm/shape.h>
#include <sdm/transform.h>

namespace sdm {

/// A motion during the time from 0 to 1: the centre of the mesh's box moves along a straight line, and the
/// body turns about it with constant speed, about one axis, by at most 180°.
struct Motion {
  Transform from{}, to{};  ///< as ProximityQuery::set_pose; with the same scale, to 1e-5

  /// The pose at a time. Throws sdm::Error as set_pose does, and for different scales.
  [[nodiscard]] SDM_API Transform at(double time, const Shape& shape) const;
};

/// The first contact of a motion.
struct TimeOfContact {
  bool contact = false;  ///< the bodies collide at `time`, or are at most the tolerance apart
  /// The bodies do not touch before this; 1 if they come no nearer than the tolerance.
  double time = 1;
  double separation = 0;  ///< at `time`; exact
};

/// Finds the first contact by conservative advancement (Mirtich & Canny 1995): no point of a body is faster
/// than its centre plus its angular speed times its radius, so the surfaces need at least their distance
/// divided by the sum of these speeds to meet. No contact is missed, however thin the bodies and long the
/// motions. Bodies that collide at first have contact at time 0.
///
/// `tolerance` > 0, in units of space. Throws sdm::Error for any other, and as Motion::at does. Cost: some
/// ten searches for the closest faces, at most one for each half tolerance of the motion, where the bodies
/// pass each other closely.
[[nodiscard]] SDM_API TimeOfContact time_of_contact(const Shape& o1, const Motion& motion1, const Shape& o2,
                                                    const Motion& motion2, double tolerance);

}  // namespace sdm
