// Placing further charts in an atlas.
#pragma once

#include <span>
#include <vector>

#include "atlas/packing/pack.h"
#include "atlas/packing/room.h"

namespace sdm::atlas {

/// Places all shapes at the given scale, each with a gutter of free texels as in pack(): where texels are
/// free, the uppermost row first, and below the atlas, which then gets more rows. Takes no room; only rows
/// are added. Throws sdm::Error if a shape is wider than the atlas, or if there would be more than kMaxRows.
/// Deterministic. Cost: linear in texels, plus the search for each shape.
[[nodiscard]] std::vector<Placement> fit(std::span<const Shape> shapes, double scale, Room& room);

/// Rows fit 16 bits, and indices of texels 32.
inline constexpr std::uint32_t kMaxRows = 65535;

}  // namespace sdm::atlas
