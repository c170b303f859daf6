// Invariants of the atlas of any mesh.
#pragma once

#include <sdm/surface.h>

namespace sdm::test {

/// Exactly the faces with an area have a chart; every chart of a packed atlas owns a texel.
void expect_charts(const Surface& surface);
/// A texel centre well inside a mapped triangle is owned by this triangle's face, so that no two triangles
/// overlap there; and each owned centre lies in the owner's mapped triangle, each texel's point on the owner.
void expect_owners(const Surface& surface);
/// Texels of two charts, and the texels that charts touch, keep `gutter` free texels each.
void expect_gutters(const Surface& surface, std::uint32_t gutter);
/// M and M⁻¹ undo each other, map corners to corners, and no face is mirrored.
void expect_maps(const Surface& surface);
/// The singular values of M⁻¹, relative to the least of all, reach max_stretch() and do not exceed it.
void expect_stretch(const Surface& surface);
/// samples() holds every owned texel once.
void expect_samples(const Surface& surface);

}  // namespace sdm::test
