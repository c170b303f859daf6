// The faces of O1 as planar domains, in the unit frame of O2: the affine maps of the paper (3.3), updated.
#pragma once

#include <sdm/raster.h>

#include <vector>

#include "atlas/surface_impl.h"
#include "engine/gl/planar_domain.h"
#include "hierarchy/aabb_tree.h"

namespace sdm::gl {

/// The texels that each face owns, in compressed rows.
struct FaceTexels {
  std::vector<std::uint32_t> offsets;  ///< one a face, and the end
  std::vector<std::uint32_t> texels;

  explicit FaceTexels(const Surface::Impl& surface);
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t face) const {
    return {texels.data() + offsets[face], texels.data() + offsets[face + 1]};
  }
};

/// The domain of a face that owns a texel. Its outline is the rectangle of its texels, cut for
/// RasterClip::planes along the face's sides.
[[nodiscard]] PlanarDomain face_domain(const Surface::Impl& surface, const FaceTexels& texels,
                                       std::uint32_t face, const UnitFrame& frame, RasterClip clip);

}  // namespace sdm::gl
