// Pictures of textures, filtered.
#pragma once

#include <sdm/mesh_attributes.h>
#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <vector>

namespace sdm::baking {

/// A picture with smaller and smaller means of it, each half as wide and as high.
class MipChain {
 public:
  /// Makes the chain of a picture that is not empty, in sRGB or of plain numbers; it must outlive this. Cost:
  /// linear, all cores, and as much memory as two thirds of a picture of 8 bits.
  MipChain(const Image& image, bool srgb);

  [[nodiscard]] std::uint32_t width() const { return image_->width; }
  [[nodiscard]] std::uint32_t height() const { return image_->height; }

  /// A place of the picture as large as a parallelogram, in pixels from its upper left corner, y down.
  struct Place {
    Vec2 centre;
    std::array<Vec2, 2> sides;
    std::array<TextureWrap, 2> wrap;
  };
  /// Returns the mean over the place of red, green, blue and alpha, colours in linear light. Samples,
  /// bilinear in a level whose pixels are at most as large as their spacing, lie evenly in it: up to three
  /// along the shorter side, and in proportion along the longer one.
  [[nodiscard]] std::array<float, 4> mean(const Place& place) const;

 private:
  struct Level {
    std::uint32_t width, height;
    std::vector<std::uint16_t> numbers;  ///< in units of 1/65535; of the first level, empty
  };

  [[nodiscard]] Level half(const Level& level) const;
  /// Calls call(numbers, count) with what reads the numbers of a level, and the number of components as a
  /// constant.
  template <class Call>
  void with_numbers(const Level& level, const Call& call) const;
  [[nodiscard]] bool is_alpha(std::uint32_t component) const {
    return image_->components % 2 == 0 && component + 1 == image_->components;
  }

  const Image* image_;
  std::vector<float> colors_, plain_;  ///< the value of each number of the first level; of alpha
  std::vector<Level> levels_;
};

}  // namespace sdm::baking
