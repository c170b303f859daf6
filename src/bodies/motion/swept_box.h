// The space that a body passes through during its motion.
#pragma once

#include "bodies/motion/divided_motion.h"
#include "bodies/shape/body.h"

namespace sdm::motion {

/// A box that contains the body at all times of the motion. Cost: constant.
[[nodiscard]] Box swept_box(const shape::Body& body, const DividedMotion& motion);

}  // namespace sdm::motion
