// Poles: vertices at which each face has texture coordinates of its own.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <map>
#include <vector>

namespace sdm::simplify {

struct Wedges;

/// What the corners of a face at a pole have: its texture coordinates, and the wedges of the other two
/// corners, in the order in which they follow.
struct PoleCorner {
  std::array<std::uint32_t, 2> next;
  Vec2 uv;
};

/// The corners at each wedge that stands for a pole.
using Poles = std::map<std::uint32_t, std::vector<PoleCorner>>;

/// Makes one wedge of those of each pole: the tip of a fan of faces that share their edges there, with the
/// same texture coordinates at the other ends, but not at the tip, as on spheres by latitude and longitude.
/// Of three faces at least: with two, it is the last edge of a cut. Removes wedges that are no longer used.
/// Cost: linear.
void merge_poles(Wedges& wedges);

/// The texture coordinates of a face at a pole, whose other corners are these: those that it had, or those of
/// the corner nearest to the middle of its other side, which is between `sides`.
[[nodiscard]] Vec2 uv_at_pole(const std::vector<PoleCorner>& corners,
                              const std::array<std::uint32_t, 2>& next, const std::array<Vec2, 2>& sides);

}  // namespace sdm::simplify
