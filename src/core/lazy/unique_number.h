// Numbers of objects that are recognised after others have taken their place in memory.
#pragma once

#include <atomic>
#include <cstdint>

namespace sdm::core {

/// A number that no other call returns; not 0.
[[nodiscard]] inline std::uint64_t unique_number() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
