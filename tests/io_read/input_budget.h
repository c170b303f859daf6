// What reading one file costs.
#pragma once

#include <cstddef>
#include <functional>

namespace sdm::test {

struct InputCost {
  std::size_t bytes = 0;  ///< the most that was allocated by operator new at once, or asked of it
  double seconds = 0;     ///< of processor time, of all threads
};

/// Calls `read` and measures it. For one thread at a time.
[[nodiscard]] InputCost cost_of(const std::function<void()>& read);

/// The budget of a file of a few kilobytes, with sanitizers: far above what any takes.
inline constexpr InputCost kInputBudget{.bytes = std::size_t{64} << 20, .seconds = 5};

}  // namespace sdm::test
