// The size of an image.
#pragma once

#include <cstddef>
#include <cstdint>

namespace sdm::gl {

/// The size of an image in texels.
struct ImageSize {
  std::uint32_t columns, rows;

  [[nodiscard]] std::size_t texels() const { return std::size_t{columns} * rows; }
};

}  // namespace sdm::gl
