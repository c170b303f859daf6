// The order of a surface's samples, in packets of 16 and blocks of 256.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sdm::surface {

class SurfaceData;

/// Samples that engines measure at once.
inline constexpr std::size_t kPacket = 16;

/// The samples, those of texels and of faces without one, in an order such that every aligned run of 16·2^k
/// of them lies in a small box on the surface, as geometry/spatial_order.h describes. Squares of 4² texels of
/// one chart stay together: they are small boxes already, and there are far fewer of them to sort. Does not
/// use SurfaceData::samples. Cost: linear in texels, plus n log n in squares and in texels beside them; all
/// cores.
[[nodiscard]] std::vector<std::uint32_t> sample_order(const SurfaceData& surface);

inline constexpr std::size_t kBlockSize = 256;  // compact on the surface: see surface/sample_order.h

/// The samples of a block: [first, end).
struct SampleBlock {
  std::size_t first, end;
  SampleBlock(std::size_t block, std::size_t samples)
      : first(block * kBlockSize), end(std::min(samples, first + kBlockSize)) {}
  [[nodiscard]] std::size_t size() const { return end - first; }
};

[[nodiscard]] inline std::size_t block_count(std::size_t samples) {
  return (samples + kBlockSize - 1) / kBlockSize;
}

class SurfaceData;

/// Removes the samples of removed faces, one flag for each face, and adds the samples `added`, whose faces
/// are those of map_faces. Of all others, those with indices from `texels_before` on, which was texels()
/// before the edit, get those that their faces have in map_faces now. Packets of 16 samples that lose none
/// stay as they are; the samples of all others and the added ones are distributed anew over these packets,
/// those near each other in space together. Changes nothing if it throws. Cost: a pass over the samples, plus
/// n log n in the samples that are distributed.
void edit_samples(SurfaceData& surface, std::span<const std::uint8_t> removed_faces,
                  std::span<const std::uint32_t> added, std::uint32_t texels_before);

}  // namespace sdm::surface
