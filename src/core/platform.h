// Calls to the operating system. The rest of the computing library is portable C++.
#pragma once

#include <cstddef>
#include <cstdint>

namespace sdm::core {

/// Bytes that can still be allocated: what the machine has available, or a lower limit of the process or its
/// container. The largest std::size_t on systems other than Linux and Windows.
[[nodiscard]] std::size_t available_memory();

/// A number that no other process on this machine has at the same time.
[[nodiscard]] std::uint64_t process_number();

/// A number that nobody can foresee, from the system.
[[nodiscard]] std::uint64_t random_number();

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
