// The wall thickness by both methods.
#pragma once

#include <sdm/measure.h>

namespace sdm::test {

struct ThicknessMaps {
  DistanceMap ball, ray;
};

inline ThicknessMaps thickness_maps(const Surface& surface, const Sites& sites, double angle = 90) {
  using enum ThicknessMethod;
  return {compute_map(surface, sites, ThicknessOptions{.method = ball, .angle = angle}),
          compute_map(surface, sites, ThicknessOptions{.method = ray, .angle = angle})};
}

}  // namespace sdm::test
