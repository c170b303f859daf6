// A direction across another one.
#pragma once

#include <sdm/types.h>

#include <cmath>

namespace sdm {

/// Some unit vector orthogonal to u, |u| = 1.
inline Vec3 unit_across(const Vec3& u) {
  return normalized(cross(u, std::abs(u[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
}

}  // namespace sdm
