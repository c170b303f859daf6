// The number of allocations.
#pragma once

#include <cstddef>

namespace sdm::test {

/// Calls of operator new in this program so far.
[[nodiscard]] std::size_t allocations();

}  // namespace sdm::test
