// Checks and errors for insufficient memory, and room that is reserved before a change.
//
// Where a file or an option determines the size, require_memory checks it before anything is allocated,
// because systems that overcommit memory kill the process instead of letting an allocation fail. Elsewhere
// sizes are proportional to data that the caller already holds: allocations may fail, and public functions
// translate std::bad_alloc into sdm::Error.
#pragma once

#include <sdm/error.h>

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

namespace sdm::core {

/// Throws sdm::Error, naming `purpose`, unless `bytes` are available.
void require_memory(std::size_t bytes, std::string_view purpose);

/// The error that public functions throw instead of std::bad_alloc: "`purpose`: not enough memory".
[[nodiscard]] Error out_of_memory(std::string_view purpose);

/// Lets `items` grow to `size` without failing. Unlike reserve(), it at least doubles the capacity if that
/// does not suffice, so that growing step by step takes linear time.
template <class Item>
void reserve_for(std::vector<Item>& items, std::size_t size) {
  if (size > items.capacity()) items.reserve(std::max(size, 2 * items.capacity()));
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
