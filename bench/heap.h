// The size of the program's heap: every operator new and delete is counted.
#pragma once

#include <cstddef>

namespace sdm::bench {

/// Bytes allocated now, including what the allocator rounds sizes up to.
[[nodiscard]] std::ptrdiff_t heap_bytes();

/// The largest number of bytes allocated at any time since the last call.
[[nodiscard]] std::ptrdiff_t heap_peak();

}  // namespace sdm::bench
