// Covering radii: the distance from any surface point to a sample, for any positions of the vertices.
#pragma once

#include <sdm/mesh.h>
#include <sdm/surface.h>

#include <memory>
#include <vector>

#include "surface/sampling_bound/measure_pieces.h"

namespace sdm::surface {

/// The point with weights (a, b), a, b ≥ 0, a + b ≤ 1, is origin + a edges[0] + b edges[1].
struct FaceFrame {
  Vec3 origin;
  std::array<Vec3, 2> edges;

  FaceFrame(const Mesh& mesh, std::size_t face) {
    const auto& [a, b, c] = mesh.triangles[face];
    origin = mesh.positions[a];
    edges = {mesh.positions[b] - origin, mesh.positions[c] - origin};
  }

  [[nodiscard]] Vec3 at(double a, double b) const { return origin + a * edges[0] + b * edges[1]; }

  /// Upper bound on the error of a point computed from weights rounded to float: at most 2⁻²⁵ per weight,
  /// plus a few roundings in double.
  [[nodiscard]] double rounding() const {
    double largest = 0;
    for (const Vec3& v : {origin, origin + edges[0], origin + edges[1]})
      for (const double x : v) largest = std::max(largest, std::abs(x));
    return 1e-14 * largest + 0x1.01p-25 * (norm(edges[0]) + norm(edges[1]));
  }
};

struct Identity;

/// Half the longer diagonal of a texel's square on the surface, given its edges: the largest distance from
/// the centre to a point of the square.
[[nodiscard]] double half_diagonal(const std::array<Vec3, 2>& texel_edges);
/// The distance from the centre of a texel's square on the face to its farthest corner, plus the rounding
/// error of M⁻¹, which places the samples, at the face's own corners.
[[nodiscard]] double square_radius(const Surface& surface, std::uint32_t face, const FaceFrame& frame);
/// x rounded up to a float.
[[nodiscard]] float rounded_up(double x);

/// A cover of the surface by convex pieces, each assigned to a sample. Samples and pieces move affinely with
/// their faces, so it is valid for any positions of the vertices. Only the radii depend on the positions. See
/// docs/theory.md, "The error bound".
///
/// The surface of each function is that which this was built for, not edited since, with any positions.
///
/// Memory: 1 byte per sample, 12 bytes per face and block in which it has samples or pieces, and 36 bytes per
/// piece. There is about one piece for every two squares crossed by an edge of a face, and one for every
/// square along chart borders.
class PieceAssignment {
 public:
  /// Assigns each piece to a nearby sample. Cost: linear in texels and pieces, all cores.
  explicit PieceAssignment(const Surface& surface);

  /// Throws sdm::Error if this was built for another surface, or before an edit of this one.
  void require_same(const Surface& surface) const;

  struct Radii {
    std::vector<float> samples;  ///< the largest distance from each sample to its pieces
    std::vector<float> faces;    ///< the largest distance from a point of each face to its sample
    double largest = 0;
  };
  /// Upper bounds, rounded upwards, on the radii. Allocates nothing if `radii` was used before. The result
  /// does not depend on the number of threads. Cost: linear in faces, samples and pieces, all cores.
  void measure(const Surface& surface, Radii& radii) const;

  /// Returns for each face the largest distance from some of its points to the nearest sample, rounded
  /// downwards: a lower bound on its radius. `bound` is the largest of the present radii. Cost: a few
  /// nearest-sample searches per face, all cores.
  [[nodiscard]] std::vector<double> radius_lower_bounds(const Surface& surface, double bound) const;

 private:
  friend class PieceAssignmentBuilder;

  /// The samples of one face in a block, and their pieces.
  struct FaceInBlock {
    std::uint32_t face = kNone;
    std::uint32_t square_end = 0,
                  piece_end = 0;  ///< its squares and pieces start at the end of the previous entry
  };
  /// Calls take(part, its squares, its pieces).
  template <class Take>
  void for_each_face(std::size_t block, const Take& take) const;
  template <class Take>
  void measure_block(const Surface& surface, std::size_t block, std::span<const Vec3> points,
                     std::span<float> radii, const Take& take_face) const;

  std::shared_ptr<const Identity> identity_;  ///< of the surface
  std::vector<std::uint32_t> block_ends_;     ///< of each block's faces
  std::vector<FaceInBlock> faces_in_blocks_;
  /// Samples, relative to the first of their block, in whose square the face contains an end of each
  /// diagonal, so that half the longer one is the radius. All parts of other squares are among the pieces.
  std::vector<std::uint8_t> squares_;
  std::vector<Piece> pieces_;
};

template <class Take>
void PieceAssignment::for_each_face(std::size_t block, const Take& take) const {
  const std::size_t first = block == 0 ? 0 : block_ends_[block - 1];
  std::size_t square = first == 0 ? 0 : faces_in_blocks_[first - 1].square_end;
  std::size_t piece = first == 0 ? 0 : faces_in_blocks_[first - 1].piece_end;
  for (std::size_t p = first; p < block_ends_[block]; ++p) {
    const FaceInBlock& part = faces_in_blocks_[p];
    take(part, std::span(squares_).subspan(square, part.square_end - square),
         std::span(pieces_).subspan(piece, part.piece_end - piece));
    square = part.square_end;
    piece = part.piece_end;
  }
}

}  // namespace sdm::surface

namespace sdm {

class SamplingBound;

/// The pieces that a SamplingBound was built with. Found by argument-dependent lookup.
[[nodiscard]] const surface::PieceAssignment& internals(const SamplingBound& bound);

}  // namespace sdm
