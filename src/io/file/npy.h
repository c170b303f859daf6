// The header of NumPy's array files.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sdm::io {

/// The index that varies fastest from one number to the next.
enum class NpyOrder { last_fastest, first_fastest };

/// The header of NPY version 1.0 (NumPy's NEP 1) for elements of `type`: a number such as "<f4", or a list of
/// fields in brackets. Padded to 128 bytes for numbers of every shape; `shape` has at most three indices.
[[nodiscard]] std::string npy_header(std::string_view type, std::span<const std::uint64_t> shape,
                                     NpyOrder order = NpyOrder::last_fastest);

}  // namespace sdm::io
