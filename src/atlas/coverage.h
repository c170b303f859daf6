// How far a surface strays from its samples, however its vertices move.
#pragma once

#include <sdm/surface.h>

#include <vector>

#include "atlas/measure_pieces.h"

namespace sdm {

/// Half the longer diagonal of a texel's square on the surface, given its edges: the farthest that a point of
/// it gets from its centre.
[[nodiscard]] double half_diagonal(const std::array<Vec3, 2>& texel_edges);

/// A cover of the surface by convex pieces, each assigned to a sample. Samples and pieces move affinely with
/// their faces, so it holds for any positions of the vertices: what depends on these is how far the pieces
/// reach, computed by `measure`. See docs/theory.md, "The error bound".
///
/// Memory: 4 bytes a sample, 10 a face, and 36 a piece: one for about every second square that an edge of a
/// face crosses, and for every one along the borders of charts.
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
  /// Upper bounds, rounded upwards, on the radii at the surface's positions; it is the surface that this was
  /// made for. Allocates nothing where `radii` was used before. The result does not depend on the number of
  /// threads. Cost: linear in faces, samples and pieces, all cores.
  void measure(const Surface& surface, Radii& radii) const;

  /// For each face the largest distance to the nearest sample of some of its points, at the surface's
  /// positions, rounded downwards: a lower bound on its radius. Cost: some nearest samples a face, all cores.
  [[nodiscard]] std::vector<double> witnessed_radii(const Surface& surface) const;

 private:
  friend class CoverageBuilder;

  /// The pieces of a few faces that are near each other, and so are the samples.
  struct Block {
    struct Face {
      std::uint32_t face, end;  ///< its pieces: from the end of the one before to its own
    };
    std::vector<Face> faces;
    std::vector<Piece> pieces;
  };

  struct Measuring;

  /// Of each sample: the face in which its square has an end of either diagonal, so that half the longer one
  /// is how far it reaches; kNone where all that the face has of the square is among the pieces.
  std::vector<std::uint32_t> square_faces_;
  std::vector<std::uint8_t> has_squares_;  ///< whether the face is among them
  std::vector<Block> blocks_;
};

/// The coverage of a surface, made at the first call, and its radii at the surface's present positions,
/// measured at the first call after a refit.
[[nodiscard]] const Coverage& coverage_of(const Surface& surface);
[[nodiscard]] const Coverage::Radii& radii_of(const Surface& surface);

}  // namespace sdm
