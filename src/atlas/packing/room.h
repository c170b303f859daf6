// Which texels of an atlas are taken, for edits: charts leave it and others take their place.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <vector>

#include "atlas/packing/bitmap_bin.h"

namespace sdm::atlas {

/// The texels that a triangle touches, with `gutter` texels around: columns [begin, end) of each row from
/// `first_row` on. Rows and columns are 0 at least.
struct TouchedRows {
  std::uint32_t first_row = 0;
  std::vector<std::array<std::uint32_t, 2>> columns;

  TouchedRows(const std::array<Vec2, 3>& triangle, std::uint32_t gutter);
};

/// Counts, for each texel, the faces that touch it or have it in their gutter, so that a face can be removed
/// without its neighbours. Cost of add and remove: linear in the texels of the face.
class Room {
 public:
  Room() = default;
  Room(std::uint32_t resolution, std::uint32_t rows, std::uint32_t gutter);

  /// The gutter is that of the constructor.
  void add(const std::array<Vec2, 3>& face);
  void remove(const std::array<Vec2, 3>& face);
  /// Adds free rows at the bottom.
  void grow(std::uint32_t rows);

  [[nodiscard]] bool empty() const { return counts_.empty(); }
  [[nodiscard]] std::uint32_t resolution() const { return resolution_; }
  [[nodiscard]] std::uint32_t rows() const { return rows_; }
  [[nodiscard]] std::uint32_t gutter() const { return gutter_; }
  /// A bin of these texels and `more_rows` free ones, for stamps with runs of at most `longest`.
  [[nodiscard]] BitmapBin bin(std::uint32_t more_rows, std::uint32_t longest) const;

 private:
  template <class Change>
  void for_each_count(const std::array<Vec2, 3>& face, const Change& change);

  std::uint32_t resolution_ = 0, rows_ = 0, gutter_ = 0;
  /// A count of kMany is not decremented again: texels of that many faces stay taken.
  static constexpr std::uint16_t kMany = 0xFFFF;
  std::vector<std::uint16_t> counts_;
};

}  // namespace sdm::atlas
