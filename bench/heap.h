// The size of the program's heap: counts every operator new and delete.
#pragma once

#include <cstddef>

namespace sdm::bench {

/// Bytes currently allocated, including those by which the allocator rounds sizes up.
[[nodiscard]] std::ptrdiff_t heap_bytes();

/// The largest number of bytes allocated at any time since the last call.
[[nodiscard]] std::ptrdiff_t heap_peak();

}  // namespace sdm::bench
