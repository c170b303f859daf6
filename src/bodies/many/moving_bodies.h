// The first contacts of many bodies that move.
#pragma once

#include <sdm/multi_body_query.h>

#include <span>
#include <vector>

#include "bodies/many/near_pairs.h"
#include "bodies/motion/divided_motion.h"
#include "bodies/shape/posed_body.h"

namespace sdm::bodies {

/// MultiBodyQuery::time_of_contact() of bodies, whatever their poses, with one motion each.
class MovingBodies {
 public:
  MovingBodies(std::span<const shape::PosedBody> bodies, std::span<const motion::DividedMotion> motions)
      : bodies_(bodies), motions_(motions) {}

  /// The first contacts of the pairs that pass the filter; on all cores.
  [[nodiscard]] std::vector<PairTimeOfContact> first_contacts(const PairFilter& filter, double tolerance,
                                                              const TimeOfContactOptions& options) const;

 private:
  [[nodiscard]] std::vector<Box> swept_boxes() const;

  std::span<const shape::PosedBody> bodies_;
  std::span<const motion::DividedMotion> motions_;
};

}  // namespace sdm::bodies
