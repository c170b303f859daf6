// The pieces of a surface that belong to samples.
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
  /// Of a few faces each, that are near each other. Samples count from the first of all.
  std::vector<std::vector<FacePiece>> face_groups;
  /// Of each sample, whether its face has an end of either diagonal of its square, none of which is among the
  /// pieces then.
  std::vector<std::uint8_t> whole_square;
};

/// Cuts the faces along the squares of the texels, and assigns each piece to a sample that is near it. Cost:
/// linear in texels and pieces, all cores.
[[nodiscard]] FacePieces cut_faces(const Surface& surface);

}  // namespace sdm::surface
