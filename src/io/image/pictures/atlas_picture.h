// Pictures of the atlas, which may be smaller than it.
#pragma once

#include <sdm/surface.h>

#include <cstdint>
#include <span>

namespace sdm::io {

/// One pixel for each texel or, if that would be more than `largest` a side, for each square of step()²
/// texels.
class AtlasPicture {
 public:
  /// The surface must outlive this.
  AtlasPicture(const Surface& surface, std::uint32_t largest);

  [[nodiscard]] std::uint32_t width() const { return width_; }  ///< pixels
  [[nodiscard]] std::uint32_t height() const { return height_; }
  [[nodiscard]] std::uint32_t step() const { return step_; }
  /// The texel that a pixel shows: the one in the middle of its square if a face owns it, otherwise another
  /// one of the square; kNone if no face owns any.
  [[nodiscard]] std::uint32_t texel(std::uint32_t x, std::uint32_t y) const {
    if (step_ > 1) return texel_of_square(x, y);
    const std::uint32_t texel = y * resolution_ + x;
    return owners_[texel] == kNone ? kNone : texel;
  }

 private:
  [[nodiscard]] std::uint32_t texel_of_square(std::uint32_t x, std::uint32_t y) const;

  std::span<const std::uint32_t> owners_;  // of texels
  std::uint32_t resolution_, rows_;        // of the atlas
  std::uint32_t step_ = 1, width_ = 0, height_ = 0;
};

}  // namespace sdm::io
