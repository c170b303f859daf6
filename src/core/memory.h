// Memory is checked before it is taken.
#pragma once

#include <cstddef>
#include <string_view>

namespace sdm::core {

/// Bytes that a new allocation may take: what the machine has available, or a lower limit set on the process.
[[nodiscard]] std::size_t available_memory();

/// Throws sdm::Error, naming `purpose`, unless `bytes` are available.
void require_memory(std::size_t bytes, std::string_view purpose);

}  // namespace sdm::core

namespace sdm {
using namespace core;  // the vocabulary of every folder
}
