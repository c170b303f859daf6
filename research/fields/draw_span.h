// The innermost loop of the slice methods: distances along a row of a slice.
#pragma once

#include <sdm/types.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sdm::fields {

/// The squared distance of each point of some rows, and the site that has it. Rows are padded, since vector
/// instructions read and write whole vectors.
struct DepthRows {
  static constexpr std::size_t kPadding = 64;

  std::size_t stride = 0;
  std::vector<float> squared;
  std::vector<std::uint32_t> winner;

  /// All points get this squared distance, and no winner.
  void reset(std::size_t width, std::size_t rows, float value);
  [[nodiscard]] std::size_t bytes() const {
    return squared.capacity() * sizeof(float) + winner.capacity() * sizeof(std::uint32_t);
  }
};

/// A vector along a row: at its first point, and its change from one point to the next.
struct SpanVector {
  float start[3], step[3];

  SpanVector(const Vec3& at_start, const Vec3& change) {
    for (int k = 0; k < 3; ++k) {
      start[k] = static_cast<float>(at_start[k]);
      step[k] = static_cast<float>(change[k]);
    }
  }
};

// Both select the best available vector instructions at run time.

/// Where the vector is shorter, replaces the squared distance and the winner of `count` points.
void draw_span(float* squared, std::uint32_t* winner, std::size_t count, const SpanVector& vector,
               std::uint32_t site);
/// Whether the vector is at most `reach` longer than the distance of any of `count` points.
[[nodiscard]] bool comes_within(const float* squared, std::size_t count, const SpanVector& vector,
                                float reach);

}  // namespace sdm::fields
