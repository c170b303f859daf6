// Covering radii: the distance from any surface point to a sample, for any positions of the vertices.
#pragma once

#include <sdm/surface.h>

#include <vector>

#include "surface/sample_blocks.h"
#include "surface/sampling_bound/measure_pieces.h"

namespace sdm::surface {

/// Half the longer diagonal of a texel's square on the surface, given its edges: the farthest that a point of
/// it gets from its centre.
[[nodiscard]] double half_diagonal(const std::array<Vec3, 2>& texel_edges);

/// A cover of the surface by convex pieces, each assigned to a sample. Samples and pieces move affinely with
/// their faces, so it holds for any positions of the vertices: what depends on these is how far the pieces
/// reach, computed by `measure` for all samples, or block by block. See docs/theory.md, "The error bound".
///
/// In all functions the surface is the one that this was made for, at whatever positions.
///
/// Memory: a byte a sample, 36 a face and block that it has samples or pieces in, and 36 a piece: about one
/// for every second square crossed by an edge of a face, and one for every square along chart borders.
class PieceAssignment {
 public:
  /// Assigns each piece to a sample that is near now. Cost: linear in texels and pieces, all cores.
  explicit PieceAssignment(const Surface& surface);

  struct Radii {
    std::vector<float> samples;  ///< the largest distance to each sample of a point of its pieces
    std::vector<float> faces;    ///< the largest distance to its sample of a point of each face
    double largest = 0;
  };
  /// Upper bounds, rounded upwards, on the radii. Allocates nothing where `radii` was used before. The result
  /// does not depend on the number of threads. Cost: linear in faces, samples and pieces, all cores.
  void measure(const Surface& surface, Radii& radii) const;

  /// The same for the samples of one block, whose points are given.
  void measure_block(const Surface& surface, std::size_t block, std::span<const Vec3> points,
                     std::span<float> radii) const;
  /// The radius of a ball about p that contains all samples of the block and their pieces. Cost: linear in
  /// the faces that these lie on.
  [[nodiscard]] double radius_about(const Surface& surface, std::size_t block, const Vec3& p) const;
  /// The same for many blocks, larger but cheaper: of a ball that contains those faces, which may lie partly
  /// in other blocks.
  [[nodiscard]] double face_radius_about(const Surface& surface, BlockRange blocks, const Vec3& p) const;

  /// For each face the largest distance to the nearest sample of some of its points, rounded downwards: a
  /// lower bound on its radius. `bound` is the largest of the present radii. Cost: some nearest samples a
  /// face, all cores.
  [[nodiscard]] std::vector<double> radius_lower_bounds(const Surface& surface, double bound) const;

 private:
  friend class PieceAssignmentBuilder;

  /// The samples of one face in a block, and their pieces.
  struct FaceInBlock {
    std::uint32_t face = kNone;
    std::uint32_t square_end = 0,
                  piece_end = 0;  ///< its squares and pieces: from the end of the entry before
    /// Its samples are the centres of texels among these; none where the lower ones are above the upper ones.
    std::array<std::uint16_t, 2> low_texel{0xFFFF, 0xFFFF}, high_texel{};
    std::array<float, 2> low_weights{1, 1}, high_weights{};  ///< of the corners of its pieces
  };
  /// Calls take(part, its squares, its pieces).
  template <class Take>
  void for_each_face(std::size_t block, const Take& take) const;
  template <class Take>
  void measure_block(const Surface& surface, std::size_t block, std::span<const Vec3> points,
                     std::span<float> radii, const Take& take_face) const;

  std::vector<std::uint32_t> block_ends_;  ///< of each block's faces
  std::vector<FaceInBlock> faces_in_blocks_;
  /// Samples, counted from the first of their block, in whose square the face has an end of either diagonal,
  /// so that half the longer one is how far it reaches. Of other squares all parts are among the pieces.
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
    square = part.square_end, piece = part.piece_end;
  }
}

}  // namespace sdm::surface

namespace sdm {

class SamplingBound;

/// The pieces that a SamplingBound was built with. Found by argument-dependent lookup.
[[nodiscard]] const surface::PieceAssignment& internals(const SamplingBound& bound);

}  // namespace sdm
