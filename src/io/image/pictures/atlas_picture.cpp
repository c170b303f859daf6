#include "io/image/pictures/atlas_picture.h"

#include <algorithm>
#include <cstddef>

namespace sdm::io {

AtlasPicture::AtlasPicture(const Surface& surface, std::uint32_t largest)
    : owners_(surface.texel_faces()), resolution_(surface.resolution()), rows_(surface.rows()) {
  const std::uint32_t longest = std::max(resolution_, rows_);
  step_ = std::max(1u, (longest + largest - 1) / std::max(1u, largest));
  width_ = (resolution_ + step_ - 1) / step_;
  height_ = (rows_ + step_ - 1) / step_;
}

std::uint32_t AtlasPicture::texel_of_square(std::uint32_t x, std::uint32_t y) const {
  const auto index = [this](std::size_t column, std::size_t row) { return row * resolution_ + column; };
  const std::uint32_t left = x * step_, top = y * step_;
  const std::uint32_t right = std::min(resolution_, left + step_), bottom = std::min(rows_, top + step_);
  const std::size_t middle = index((left + right) / 2, (top + bottom) / 2);
  if (owners_[middle] != kNone) return static_cast<std::uint32_t>(middle);
  for (std::uint32_t row = top; row < bottom; ++row)
    for (std::uint32_t column = left; column < right; ++column)
      if (const std::size_t texel = index(column, row); owners_[texel] != kNone)
        return static_cast<std::uint32_t>(texel);
  return kNone;
}

}  // namespace sdm::io
