// The paper's decomposition M = A_t A_s A_r of the affine map of a face (3.3).
#pragma once

#include <sdm/surface.h>

#include <cstdint>

namespace sdm::figures {

/// A_s: scale and shear in the plane, in texels per unit of length: rows (sx, sh·sy) and (0, sy). A_r rotates
/// the plane of the face to that of the atlas, A_t translates.
struct AffineMap {
  double sx = 0, sy = 0, sh = 0;
};

/// Decomposes M of a face with a chart by a QR factorisation. The shear is along the first edge of the face.
[[nodiscard]] AffineMap affine_map(const Surface& surface, std::uint32_t face);

/// The centre of a texel in atlas coordinates.
[[nodiscard]] Vec2 texel_centre(const Surface& surface, std::uint32_t texel);

}  // namespace sdm::figures
