// Errors about memory.
//
// Where a file or an option decides how much is needed, require_memory refuses before anything is allocated:
// most systems grant more memory than there is, and end the process when it is used. Elsewhere the size is
// that of what the caller holds in memory already: the public functions let an allocation fail, and turn
// std::bad_alloc into sdm::Error.
#pragma once

#include <sdm/error.h>

#include <cstddef>
#include <string_view>

namespace sdm::core {

/// Throws sdm::Error, naming `purpose`, unless `bytes` are available.
void require_memory(std::size_t bytes, std::string_view purpose);

/// What public functions, in a function-try-block, throw in place of std::bad_alloc: "`purpose`: not enough
/// memory".
[[nodiscard]] Error out_of_memory(std::string_view purpose);

}  // namespace sdm::core

namespace sdm {
using namespace core;  // the vocabulary of every folder
}
