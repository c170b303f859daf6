/// Progress of long work, and its cancellation.
#pragma once

#include <functional>
#include <string_view>

namespace sdm {

/// Called now and then, from one thread at a time, with the step at hand ("atlas", "map", ...) and the
/// fraction of it that is done, in [0, 1]. Return false to cancel: the work then throws sdm::Cancelled.
/// Whoever makes an OpenGL context current in it restores the former one: the gl engine's may be in use.
using Progress = std::function<bool(std::string_view step, double fraction)>;

}  // namespace sdm
