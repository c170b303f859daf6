// Cuts of a triangle of A along the sides of a face of B, so that one piece lies above the face.
#pragma once

#include <array>
#include <optional>

#include "geometry/triangle.h"

namespace sdm::hausdorff {

/// A cut of a triangle by a line: one corner is alone on its side of it.
struct SideCut {
  int alone = 0;
  std::array<double, 2> at{};  ///< along the sides from that corner to the next two
};

/// The cut along the side of a face that the triangle reaches beyond the most, moved outwards by `offset`.
/// `normal`: of the face, of length 1. Nothing unless there are corners farther than `margin` from the line
/// on either side of it.
[[nodiscard]] std::optional<SideCut> cut_along_side(const Corners& triangle, const Corners& face,
                                                    const Vec3& normal, double offset, double margin);

[[nodiscard]] double longest_side(const Corners& triangle);

}  // namespace sdm::hausdorff
