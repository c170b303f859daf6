#include "io/image/pictures/atlas_picture.h"

#include <algorithm>
#include <cstddef>

namespace sdm::io {

AtlasPicture::AtlasPicture(const Surface& surface, std::uint32_t largest) : surface_(surface) {
  const std::uint32_t n = surface.resolution(), longest = std::max(n, surface.rows());
  step_ = std::max(1u, (longest + largest - 1) / std::max(1u, largest));
  width_ = (n + step_ - 1) / step_;
  height_ = (surface.rows() + step_ - 1) / step_;
}

std::uint32_t AtlasPicture::texel(std::uint32_t x, std::uint32_t y) const {
  const std::uint32_t n = surface_.resolution();
  const auto owners = surface_.texel_faces();
  const auto index = [n](std::size_t column, std::size_t row) { return row * n + column; };
  if (step_ == 1) {
    const std::size_t texel = index(x, y);
    return owners[texel] == kNone ? kNone : static_cast<std::uint32_t>(texel);
  }
  const std::uint32_t left = x * step_, top = y * step_;
  const std::uint32_t right = std::min(n, left + step_), bottom = std::min(surface_.rows(), top + step_);
  const std::size_t middle = index((left + right) / 2, (top + bottom) / 2);
  if (owners[middle] != kNone) return static_cast<std::uint32_t>(middle);
  for (std::uint32_t row = top; row < bottom; ++row)
    for (std::uint32_t column = left; column < right; ++column)
      if (const std::size_t texel = index(column, row); owners[texel] != kNone)
        return static_cast<std::uint32_t>(texel);
  return kNone;
}

}  // namespace sdm::io
