/// Several samples a texel: values on a grid that is finer than the texture, of which each texel is a square.
///
/// Threads: the functions may be called concurrently.
#pragma once

#include <sdm/api.h>
#include <sdm/atlas.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sdm {

/// Rows of samples; each texel has side · side of them.
struct SampleGrid {
  std::uint32_t resolution = 0;  ///< samples per row, a multiple of the side
  std::uint32_t side = 1;        ///< of a texel, in samples

  /// Texels per row.
  [[nodiscard]] std::uint32_t texels() const { return resolution / side; }
};

/// Values as the mean of samples makes them, and how much of each texel they are from.
struct TexelMeans {
  std::vector<float> values;    ///< NaN for texels without a sample that has values
  std::vector<float> coverage;  ///< for each texel the share, from 0 to 1, of its samples that have values
};

/// What the mean of samples is.
enum class SampleKind : std::uint8_t {
  numbers,    ///< the arithmetic mean: of colours in linear light, that of the light
  directions  ///< its direction, of length 1: of three components that are unit vectors
};

/// Returns the side of the square of so many samples a texel: the root of 1, 4, 9 and so on up to 64; nothing
/// for other numbers.
[[nodiscard]] SDM_API std::optional<std::uint32_t> sample_side(std::int64_t samples);

/// Returns the layout of samples, side · side for each texel of a layout: that of a finer texture, in which
/// charts of different texels do not meet. Throws sdm::Error if it has fewer texels per row than a surface
/// may have, or more samples.
[[nodiscard]] SDM_API AtlasOptions sample_layout(const AtlasOptions& texels, std::uint32_t side);

// The functions below throw sdm::Error unless the samples are whole rows of texels, and if there is not
// enough memory. Their cost is linear in samples, all cores.

/// Returns the means of samples of `components` numbers each. Those that are not all finite count as none.
/// Directions that cancel out are those of the first sample.
[[nodiscard]] SDM_API TexelMeans mean_of_samples(const SampleGrid& grid, std::size_t components,
                                                 std::span<const float> samples,
                                                 SampleKind kind = SampleKind::numbers);

/// Returns the number that most samples of each texel have, the least one of several; kNone, which counts as
/// none, for texels that have no other.
[[nodiscard]] SDM_API std::vector<std::uint32_t> most_frequent_samples(
    const SampleGrid& grid, std::span<const std::uint32_t> samples);

}  // namespace sdm
