// Values for the texels that no face owns.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "atlas/gutter.h"

namespace sdm::map {

/// What a texel of an atlas has.
enum class TexelState : std::uint8_t {
  free,     ///< no face; gets a value
  valued,   ///< a value, to be kept
  missing,  ///< a face but no value, or none that is finite; stays as it is
};

/// Values extend no farther from valued texels than this; beyond it, smooth ones look better.
inline constexpr std::uint32_t kWidestGutter = 16;

/// How far the values of the texels of an atlas with this gutter extend.
[[nodiscard]] inline std::uint32_t gutter_of_values(std::uint32_t gutter) {
  return std::clamp(gutter, atlas::kGutter, kWidestGutter);
}

/// Sets the `components` values of each free texel: within `gutter` texels of valued ones to those of the
/// nearest, elsewhere by push-pull (Gortler et al., The Lumigraph, 1996, 3.4): the means of ever larger
/// squares, where smaller ones have nothing. `states`: whole rows of `resolution` texels; those within
/// `gutter` become valued. Nothing changes if no texel has a value. Cost: linear in texels, all cores, and
/// for each texel 2 bytes and a third of components + 1 floats.
void fill_free_texels(std::uint32_t resolution, std::span<TexelState> states, std::uint32_t gutter,
                      std::size_t components, std::span<float> values);

}  // namespace sdm::map
