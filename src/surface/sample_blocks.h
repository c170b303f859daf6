// Blocks of 256 consecutive samples; the last block may be shorter.
#pragma once

#include <algorithm>
#include <cstddef>

namespace sdm::surface {

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

}  // namespace sdm::surface
