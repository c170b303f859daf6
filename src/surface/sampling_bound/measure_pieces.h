// The largest distance from a point to convex pieces of faces: all corners of a piece at once.
#pragma once

#include <sdm/types.h>

#include <span>

namespace sdm::surface {

/// Four points of a face: the corners of a convex polygon, the last one repeated if there are fewer. A
/// polygon with more corners is stored as several consecutive pieces of the same sample.
struct Piece {
  std::uint32_t sample;  ///< that it is assigned to, relative to the first of its block
  std::array<std::array<float, 4>, 2> weights;  ///< of the face's edges to its vertices 1 and 2
};

/// Sets squared[i] to the square of the largest distance of a corner of pieces[i] from its sample, in double.
/// The points of the face are origin + weights[0] edges[0] + weights[1] edges[1]; `points` are those of the
/// block's samples. As |p − s| is convex in p, no other point of the piece is farther.
void measure_pieces(std::span<const Piece> pieces, const Vec3& origin, const std::array<Vec3, 2>& edges,
                    std::span<const Vec3> points, std::span<double> squared);

}  // namespace sdm::surface
