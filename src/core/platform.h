// What differs between operating systems. Nothing else in the library's core calls one directly.
#pragma once

#include <cstddef>
#include <cstdint>

namespace sdm::core {

/// Bytes that a new allocation may take: what the machine has available, or a lower limit set on the process
/// or its container. The largest number where the system has no way to find out that is known here.
[[nodiscard]] std::size_t available_memory();

/// A number that no other process running on this machine has.
[[nodiscard]] std::uint64_t process_number();

}  // namespace sdm::core

namespace sdm {
using namespace core;  // the vocabulary of every folder
}
