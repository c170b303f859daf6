/// Progress and cancellation of long computations.
#pragma once

#include <functional>
#include <string_view>

namespace sdm {

/// Called repeatedly, from one thread at a time, with the current step ("atlas", "map", ...) and the fraction
/// of it that is done, in [0, 1]. Return false to cancel: the computation then throws sdm::Cancelled. A
/// callback that makes an OpenGL context current must restore the previous one, which may be the gl engine's.
using Progress = std::function<bool(std::string_view step, double fraction)>;

}  // namespace sdm
