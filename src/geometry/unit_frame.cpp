#include "geometry/unit_frame.h"

#include <algorithm>
#include <cmath>

#include "geometry/vec.h"

namespace sdm::core {

UnitFrame UnitFrame::of(const Box& box) {
  const Vec3 size = box.upper - box.lower;
  const double longest = std::max({size[0], size[1], size[2]});
  UnitFrame frame;
  frame.origin = centre(box);
  if (longest > 0) {
    int exponent = 0;
    std::frexp(0.5 * longest, &exponent);
    frame.scale = std::ldexp(1.0, std::clamp(-exponent, -1000, 1000));  // finite, and so is its inverse
  }
  return frame;
}

}  // namespace sdm::core
