// Arrays of numbers as bytes of binary files.
#pragma once

#include <algorithm>
#include <ostream>
#include <span>
#include <string>

#include "core/cancellation.h"
#include "io/file/little_endian.h"

namespace sdm::io {

/// Writes the numbers, with their lowest bytes first.
template <class T>
void write_numbers(std::ostream& out, std::span<const T> numbers) {
  constexpr std::size_t kMost = 1 << 16;  // at a time
  std::string bytes;
  for (std::size_t i = 0; i < numbers.size(); i += kMost) {
    poll();
    bytes.clear();
    for (const T number : numbers.subspan(i, std::min(kMost, numbers.size() - i)))
      append_little_endian(bytes, number);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
}

}  // namespace sdm::io
