// Tiles of O1's faces as planar domains, in the unit frame of O2: the affine maps of the paper (3.3),
// updated.
#pragma once

#include <sdm/gl.h>
#include <sdm/surface.h>

#include "engine/gl/planar_domain.h"
#include "hierarchy/aabb_tree.h"
#include "surface/tiles.h"

namespace sdm::gl {

/// The domain of a tile; its id is its face. Its outline is the rectangle of its texels, cut for
/// GlClip::planes along the face's sides.
[[nodiscard]] PlanarDomain face_domain(const Surface& surface, const surface::Tiles& tiles,
                                       std::uint32_t tile, const UnitFrame& frame, GlClip clip);

}  // namespace sdm::gl
