// A rectangle of cells into which shapes of cells are packed, row by row.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sdm::atlas {

/// Cells [begin, begin + length) of a row.
struct Run {
  std::uint32_t row, begin, length;
};

/// A shape of cells in a rectangle: its runs, the longest first (the most likely to fail), the others
/// preferably ordered so that runs of neighbouring rows, which tend to fail at the same positions, are far
/// apart.
struct Stamp {
  std::uint32_t width = 0, height = 0;
  std::vector<Run> runs;
};

/// Each row is stored as bitmaps of 64 columns per word: level k has bit x set when one of the 2^k cells from
/// x on is taken. A run of length l, 2^k ≤ l < 2^(k+1), then fits at x where neither bit x nor bit x + l −
/// 2^k of level k is set: two shifted words test 64 positions.
class BitmapBin {
 public:
  struct Spot {
    std::uint32_t x, y;
  };

  BitmapBin(std::uint32_t width, std::uint32_t height);
  /// Makes a bin for runs of at most `longest` cells; cells are taken where `taken`, of whole rows from the
  /// first on, is not 0.
  BitmapBin(std::uint32_t width, std::uint32_t height, std::uint32_t longest,
            std::span<const std::uint16_t> taken);
  /// The memory of a bin of this size, in bytes.
  [[nodiscard]] static std::size_t bytes(std::uint32_t width, std::uint32_t height);

  /// The position with the smallest y in [first_y, end_y), then the smallest x, at which no cell of the stamp
  /// is taken.
  [[nodiscard]] std::optional<Spot> first_fit(const Stamp& stamp, std::uint32_t first_y, std::uint32_t end_y);
  void place(const Stamp& stamp, Spot spot);

 private:
  [[nodiscard]] std::optional<std::uint32_t> fit_in_row(const Stamp& stamp, std::uint32_t y,
                                                        std::vector<std::uint64_t>& blocked) const;
  [[nodiscard]] std::uint64_t* row(std::uint32_t level, std::uint32_t y) {
    return &bits_[(std::size_t{level} * height_ + y) * stride_];
  }
  [[nodiscard]] const std::uint64_t* row(std::uint32_t level, std::uint32_t y) const {
    return &bits_[(std::size_t{level} * height_ + y) * stride_];
  }
  void update_levels(std::uint32_t y, std::uint32_t begin, std::uint32_t end);
  void update_longest(std::uint32_t y);

  std::uint32_t width_, height_, levels_;
  std::size_t stride_;  // words per row; bits from width_ on are always set
  std::vector<std::uint64_t> bits_;
  // An upper bound on the free spans of a row, which rejects most rows. Exact except for stale rows.
  std::vector<std::uint32_t> longest_;
  std::vector<std::uint8_t> stale_;
};

}  // namespace sdm::atlas
