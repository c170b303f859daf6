#include "closest/facing/facing_angle.h"

#include <sdm/error.h>

#include <cmath>
#include <numbers>

#include "geometry/rounding.h"

namespace sdm::facing {
namespace {

double cosine_of(double angle) {
  check_angle(angle);
  return std::cos(angle * std::numbers::pi / 180) - kDoubleRounding;
}

}  // namespace

void check_angle(double angle) {
  if (!(angle > 0 && angle <= 180))
    throw Error("the angle within which faces face the samples must be above 0 and at most 180 degrees");
}

FacingAngle::FacingAngle(double degrees) : right_angle_(degrees == 90), least_cosine_(cosine_of(degrees)) {}

}  // namespace sdm::facing
