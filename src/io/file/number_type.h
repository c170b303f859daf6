// The types of numbers in binary files.
#pragma once

#include <array>
#include <cstdint>

#include "io/file/byte_scanner.h"

namespace sdm::io {

enum class NumberType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

/// Returns the size of a number in bytes.
[[nodiscard]] constexpr std::size_t size_of(NumberType type) {
  constexpr std::array<std::size_t, 10> kSizes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

/// Returns the number stored at `bytes`; one of 64 bits is rounded.
[[nodiscard]] inline double load_number(const char* bytes, NumberType type, std::endian order) {
  switch (type) {
    case NumberType::int8:
      return load<std::int8_t>(bytes, order);
    case NumberType::uint8:
      return load<std::uint8_t>(bytes, order);
    case NumberType::int16:
      return load<std::int16_t>(bytes, order);
    case NumberType::uint16:
      return load<std::uint16_t>(bytes, order);
    case NumberType::int32:
      return load<std::int32_t>(bytes, order);
    case NumberType::uint32:
      return load<std::uint32_t>(bytes, order);
    case NumberType::int64:
      return static_cast<double>(load<std::int64_t>(bytes, order));
    case NumberType::uint64:
      return static_cast<double>(load<std::uint64_t>(bytes, order));
    case NumberType::float32:
      return load<float>(bytes, order);
    case NumberType::float64:
      break;
  }
  return load<double>(bytes, order);
}

}  // namespace sdm::io
