// Samples in blocks of neighbours; the last block may be shorter.
#pragma once

#include <algorithm>
#include <cstddef>

namespace sdm::surface {

inline constexpr std::size_t kRunLength = 256;  // a compact piece of the surface: see core/spatial_order.h

/// The samples of a run: [first, end).
struct SampleBlock {
  std::size_t first, end;
  SampleBlock(std::size_t run, std::size_t samples)
      : first(run * kRunLength), end(std::min(samples, first + kRunLength)) {}
  [[nodiscard]] std::size_t size() const { return end - first; }
};

/// Runs that follow each other: [first, end).
struct RunRange {
  std::size_t first, end;
  /// The sample in their middle.
  [[nodiscard]] std::size_t middle(std::size_t samples) const {
    return (SampleBlock(first, samples).first + SampleBlock(end - 1, samples).end) / 2;
  }
};

[[nodiscard]] inline std::size_t run_count(std::size_t samples) {
  return (samples + kRunLength - 1) / kRunLength;
}

}  // namespace sdm::surface
