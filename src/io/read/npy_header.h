// The header of NumPy's array files (NEP 1).
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>
#include <vector>

namespace sdm::io {

/// An array of floating-point numbers.
struct NpyHeader {
  std::size_t number_bytes = 0;  ///< 4 or 8
  std::endian order = std::endian::little;
  bool fortran_order = false;  ///< the first index runs fastest, else the last one
  std::vector<std::uint64_t> shape;
  std::size_t data_begin = 0;  ///< in the file
};

/// No header that NumPy writes for numbers is longer.
inline constexpr std::size_t kMaxNpyHeader = 65536;

/// From the first bytes of a file, kMaxNpyHeader or all that there are. Throws sdm::Error where they are no
/// such header, or that of an array of anything but float32 and float64.
[[nodiscard]] NpyHeader parse_npy_header(std::string_view bytes);

}  // namespace sdm::io
