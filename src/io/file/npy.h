// The header of NumPy's array files.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sdm::io {

/// The layout of an array of floating-point numbers.
struct NpyHeader {
  std::size_t number_bytes = 0;  ///< 4 or 8
  std::endian order = std::endian::little;
  bool fortran_order = false;  ///< the first index varies fastest, else the last
  std::vector<std::uint64_t> shape;
  std::size_t data_begin = 0;  ///< byte offset in the file
};

/// An upper bound on the headers that NumPy writes for arrays of numbers.
inline constexpr std::size_t kMaxNpyHeader = 65536;

/// Parses the first kMaxNpyHeader bytes of a file, or all if it is shorter. Throws sdm::Error if they are not
/// an NPY header, or the array is not of type float32 or float64.
[[nodiscard]] NpyHeader parse_npy_header(std::string_view bytes);

/// The index that varies fastest from one number to the next.
enum class NpyOrder { last_fastest, first_fastest };

/// The header of NPY version 1.0 (NumPy's NEP 1) for elements of `type`: a number such as "<f4", or a list of
/// fields in brackets. Padded to 128 bytes for numbers of every shape; `shape` has at most three indices.
[[nodiscard]] std::string npy_header(std::string_view type, std::span<const std::uint64_t> shape,
                                     NpyOrder order = NpyOrder::last_fastest);

}  // namespace sdm::io
