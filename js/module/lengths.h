// Numbers with their bounds, as arrays of double.
#pragma once

#include <sdm/bounds.h>

#include <cmath>

#include "module/result.h"

namespace sdm::js {

/// value, lower, upper, certainty, and the witness: two points, NaN if there is none.
inline void add_length(Result& result, const BoundedLength& length) {
  const std::array<Vec3, 2> none{Vec3{NAN, NAN, NAN}, Vec3{NAN, NAN, NAN}};
  const auto [p, q] = length.witness.value_or(none);
  result.add_numbers(length.value, length.lower, length.upper, static_cast<int>(length.certainty), p[0], p[1],
                     p[2], q[0], q[1], q[2]);
}

}  // namespace sdm::js
