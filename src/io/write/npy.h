// The header of NumPy's array files.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sdm::io {

/// The header of NPY version 1.0 (NumPy's NEP 1) for numbers of `type`, such as "<f4", with the last index
/// varying fastest. Padded to 128 bytes for every shape; `shape` has at most three indices.
[[nodiscard]] std::string npy_header(std::string_view type, std::span<const std::uint64_t> shape);

}  // namespace sdm::io
