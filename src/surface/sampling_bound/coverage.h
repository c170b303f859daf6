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
/// reach, computed by `measure` for all samples, or run by run. See docs/theory.md, "The error bound".
///
/// In all functions the surface is the one that this was made for, at whatever positions.
///
/// Memory: a byte a sample, 36 a face and run that it has samples or pieces in, and 36 a piece: about one for
/// every second square crossed by an edge of a face, and one for every square along chart borders.
class Coverage {
 public:
  /// Assigns each piece to a sample that is near now. Throws sdm::Error when there is no memory for it. Cost:
  /// linear in texels and pieces, all cores.
  explicit Coverage(const Surface& surface);

  struct Radii {
    std::vector<float> samples;  ///< the largest distance to each sample of a point of its pieces
    std::vector<float> faces;    ///< the largest distance to its sample of a point of each face
    double largest = 0;
  };
  /// Upper bounds, rounded upwards, on the radii. Allocates nothing where `radii` was used before. The result
  /// does not depend on the number of threads. Cost: linear in faces, samples and pieces, all cores.
  void measure(const Surface& surface, Radii& radii) const;

  /// The same for the samples of one run, whose points are given.
  void measure_run(const Surface& surface, std::size_t run, std::span<const Vec3> points,
                   std::span<float> radii) const;
  /// No sample of the run, and no point of their pieces, is farther from p. Cost: linear in the faces that
  /// these lie on.
  [[nodiscard]] double spread(const Surface& surface, std::size_t run, const Vec3& p) const;
  /// The same of many runs, larger and sooner found: those faces may lie partly elsewhere, but no corner of
  /// them is farther from p.
  [[nodiscard]] double face_spread(const Surface& surface, RunRange runs, const Vec3& p) const;

  /// For each face the largest distance to the nearest sample of some of its points, rounded downwards: a
  /// lower bound on its radius. Cost: some nearest samples a face, all cores.
  [[nodiscard]] std::vector<double> radius_lower_bounds(const Surface& surface) const;

 private:
  friend class CoverageBuilder;

  /// The samples of one face in a block, and their pieces.
  struct Patch {
    std::uint32_t face = kNone;
    std::uint32_t square_end = 0,
                  piece_end = 0;  ///< its squares and pieces: from the end of the patch before
    /// Its samples are the centres of texels among these; none where the lower ones are above the upper ones.
    std::array<std::uint16_t, 2> low_texel{0xFFFF, 0xFFFF}, high_texel{};
    std::array<float, 2> low_weights{1, 1}, high_weights{};  ///< of the corners of its pieces
  };
  /// Calls take(patch, its squares, its pieces).
  template <class Take>
  void for_each_patch(std::size_t run, const Take& take) const;
  template <class Take>
  void measure_run(const Surface& surface, std::size_t run, std::span<const Vec3> points,
                   std::span<float> radii, const Take& take_face) const;

  std::vector<std::uint32_t> run_ends_;  ///< of each run's patches
  std::vector<Patch> patches_;
  /// Samples, counted from the first of their run, in whose square the face has an end of either diagonal, so
  /// that half the longer one is how far it reaches. Of other squares all parts are among the pieces.
  std::vector<std::uint8_t> squares_;
  std::vector<Piece> pieces_;
};

template <class Take>
void Coverage::for_each_patch(std::size_t run, const Take& take) const {
  const std::size_t first = run == 0 ? 0 : run_ends_[run - 1];
  std::size_t square = first == 0 ? 0 : patches_[first - 1].square_end;
  std::size_t piece = first == 0 ? 0 : patches_[first - 1].piece_end;
  for (std::size_t p = first; p < run_ends_[run]; ++p) {
    const Patch& patch = patches_[p];
    take(patch, std::span(squares_).subspan(square, patch.square_end - square),
         std::span(pieces_).subspan(piece, patch.piece_end - piece));
    square = patch.square_end, piece = patch.piece_end;
  }
}

/// The coverage of a surface, made at the first call, and its radii at the surface's present positions,
/// measured at the first call after a refit.
[[nodiscard]] const Coverage& coverage_of(const Surface& surface);
[[nodiscard]] const Coverage::Radii& radii_of(const Surface& surface);

}  // namespace sdm::surface
