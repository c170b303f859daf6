// Which distances are out of a tolerance although they are rounded.
#pragma once

#include <sdm/tolerance.h>

#include "core/rules.h"

namespace sdm::map {

class ToleranceLimits {
 public:
  ToleranceLimits(const Tolerance& tolerance, double accuracy) : limits_(tolerance), accuracy_(accuracy) {}

  [[nodiscard]] bool below(double d) const { return rules::is_below(d, limits_.lower, accuracy_); }
  [[nodiscard]] bool above(double d) const { return rules::is_above(d, limits_.upper, accuracy_); }

 private:
  Tolerance limits_;
  double accuracy_;
};

}  // namespace sdm::map
