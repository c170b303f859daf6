// Tiles of O1's faces as planar domains in the unit frame of O2: the paper's affine maps (3.3), refitted to
// the current vertices.
#pragma once

#include <sdm/gl.h>
#include <sdm/surface.h>

#include "geometry/unit_frame.h"
#include "gl/polygons/planar_domain.h"
#include "surface/tiles.h"

namespace sdm::gl {

/// The domain of a tile; its id is its face. Its outline is the rectangle of its texels, clipped along the
/// face's sides for GlClip::planes.
[[nodiscard]] PlanarDomain face_domain(const Surface& surface, const surface::Tiles& tiles,
                                       std::uint32_t tile, const UnitFrame& frame, GlClip clip);

}  // namespace sdm::gl
