// How far two surfaces are from each other, as it decides a limit.
#pragma once

#include <sdm/bounds.h>
#include <sdm/execution.h>
#include <sdm/sites.h>

namespace sdm::simplify {

/// What is known before.
struct Expected {
  double limit = kInfinity;  ///< what is asked is whether the distance exceeds this
  double estimate = 0;       ///< of the distance
};

/// Bounds on the symmetric Hausdorff distance of a mesh and the input that it was made from, in two steps:
/// what the points of the input say, and what those of the result add. With a finite limit, bounds are no
/// closer than needed to tell on which side of it the distance is: the upper one may then be the limit. After
/// the first step, that one holds in the one direction only; the second one is not needed where the lower
/// bound exceeds the limit.
///
/// The points of the input are measured first: that costs less, as the faces of the result are divided until
/// their parts are as small as the faces of the input near them, unless these parts cannot exceed what is
/// known.
[[nodiscard]] BoundedLength deviation_of_input(const Sites& input, const Mesh& result,
                                               const Expected& expected, const Progress& progress);
[[nodiscard]] BoundedLength with_deviation_of_result(const BoundedLength& of_input, const Sites& input,
                                                     const Mesh& result, const Expected& expected,
                                                     const Progress& progress);

}  // namespace sdm::simplify
