// Pieces of a surface, assigned to samples.
#pragma once

#include <sdm/surface.h>

#include <vector>

#include "surface/sampling_bound/measure_pieces.h"

namespace sdm::surface {

struct FacePiece {
  std::uint32_t face;
  Piece piece;
};

struct FacePieces {
  /// Each group holds the pieces of a few neighbouring faces. Sample indices are global.
  std::vector<std::vector<FacePiece>> face_groups;
  /// Whether the face of each sample contains an end of each diagonal of its square; no part of such a
  /// square is among the pieces.
  std::vector<std::uint8_t> whole_square;
};

/// Cuts the faces along the squares of the texels, and assigns each piece to a sample that is near it. Cost:
/// linear in texels and pieces, all cores.
[[nodiscard]] FacePieces cut_faces(const Surface& surface);

}  // namespace sdm::surface
