// The size of an atlas in messages.
#pragma once

#include <cstdint>
#include <string>

namespace sdm::atlas {

/// "1024²", or "2048 × 1024" if the sides differ.
[[nodiscard]] inline std::string size_text(std::uint64_t columns, std::uint64_t rows) {
  return std::to_string(columns) + (rows == columns ? "²" : " × " + std::to_string(rows));
}

}  // namespace sdm::atlas
