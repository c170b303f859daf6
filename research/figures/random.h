// Random numbers that are the same with every standard library.
#pragma once

#include <cstdint>
#include <random>

namespace sdm::figures {

class Random {
 public:
  explicit Random(std::uint32_t seed) : generator_(seed) {}
  /// In [0, 1).
  [[nodiscard]] double unit() { return static_cast<double>(generator_()) / 4294967296.0; }

 private:
  std::mt19937 generator_;
};

}  // namespace sdm::figures
