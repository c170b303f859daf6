// How much memory the program's heap holds: every operator new and delete is counted.
#pragma once

#include <cstddef>

namespace sdm::bench {

/// Bytes that are allocated now, as the allocator rounds them up.
[[nodiscard]] std::ptrdiff_t heap_bytes();

/// The largest number of them since the last call.
[[nodiscard]] std::ptrdiff_t heap_peak();

}  // namespace sdm::bench
