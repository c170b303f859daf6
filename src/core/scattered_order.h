// An order in which consecutive items are far apart.
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

namespace sdm::core {

/// A permutation of 0 ... count − 1 that starts with 0: the multiples, modulo count, of a step coprime to
/// count and close to count divided by the golden ratio.
inline std::vector<std::uint32_t> scattered_order(std::size_t count) {
  auto step = static_cast<std::size_t>(0.6180339887 * static_cast<double>(count)) | 1;
  while (std::gcd(step, count) != 1) ++step;
  std::vector<std::uint32_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = static_cast<std::uint32_t>(i * step % count);
  return order;
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
