// Numbers as text, for messages.
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace sdm::core {

/// The number with at most so many significant digits, as "%g" has it.
[[nodiscard]] inline std::string number_text(double number, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, number);
  return text.data();
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
