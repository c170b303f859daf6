// Numbers as bytes of binary files.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <string>

namespace sdm::io {

template <typename T>
void append_little_endian(std::string& bytes, T value) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(raw);
  bytes.append(raw.data(), raw.size());
}

}  // namespace sdm::io
