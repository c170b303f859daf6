// The first time at which two moving surfaces are within a tolerance of each other.
#pragma once

#include <atomic>
#include <functional>

#include "bodies/motion/parts.h"

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

}  // namespace sdm::motion
