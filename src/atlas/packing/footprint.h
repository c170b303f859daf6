// The texels that a chart covers, and its gutter around them.
#pragma once

#include <array>
#include <optional>

#include "atlas/charts/shape.h"
#include "atlas/packing/bitmap_bin.h"

namespace sdm::atlas {

/// A shape scaled to texels, in a rectangle of texels: in-rectangle position = scale · shape + shift. The
/// stamp for a number of quarter turns holds every cell of `cell`² texels that a face touches, and the
/// gutter, rounded up to cells.
struct Footprint {
  Vec2 shift{};
  std::uint32_t width = 0, height = 0;  ///< of the rectangle, multiples of the cell
  std::array<Stamp, 4> stamps;
};

struct FootprintOptions {
  double scale = 1;
  std::uint32_t gutter = 1, cell = 1;
};

/// The shape's bounds, gutter included, may span tens of thousands of texels at most. The shift is such that
/// at least one texel centre lies in a face.
[[nodiscard]] Footprint make_footprint(const Shape& shape, const FootprintOptions& options);

/// The position of a point of the rectangle after rotating the rectangle by quarter turns from x towards y:
/// proper rotations, which map texels to texels.
[[nodiscard]] Vec2 turned(const Footprint& footprint, unsigned quarter_turns, const Vec2& point);

/// Where a footprint goes: after `turn` quarter turns, with no cell in the rows from `bottom` on.
struct TurnedSpot {
  BitmapBin::Spot spot;
  unsigned turn;
  std::uint32_t bottom;
};

/// The rotation that extends least far down, within `rows`. first_fit(stamp, end_y) returns a spot for a
/// stamp whose y is less than end_y, or nothing.
template <class FirstFit>
std::optional<TurnedSpot> lowest_turn(const Footprint& footprint, std::uint32_t rows,
                                      const FirstFit& first_fit) {
  std::optional<TurnedSpot> best;
  std::uint32_t bottom = rows + 1;  // an upper bound
  for (unsigned turn = 0; turn < 4; ++turn) {
    const Stamp& stamp = footprint.stamps[turn];
    if (stamp.height >= bottom) continue;
    const std::optional<BitmapBin::Spot> spot = first_fit(stamp, bottom - stamp.height);
    if (!spot) continue;
    bottom = spot->y + stamp.height;
    best = {*spot, turn, bottom};
  }
  return best;
}

}  // namespace sdm::atlas
