// Wall-clock time of consecutive steps.
#pragma once

#include <chrono>
#include <utility>

namespace sdm::core {

class Stopwatch {
 public:
  /// Milliseconds since construction or the previous call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double, std::milli>(now - std::exchange(start_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
