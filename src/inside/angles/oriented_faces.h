// Triangles with an orientation of each, and a tree over them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "mesh/crossings/ray_parity.h"
#include "sites/sites_data.h"

namespace sdm::inside {

struct OrientedFaces {
  FaceTree faces;
  std::span<const std::uint8_t> inverted;  ///< of each face: its corners are taken in reverse; empty: of none

  /// The corners in the order of the orientation.
  [[nodiscard]] std::array<Vec3, 3> corners(std::uint32_t face) const {
    const Triangle& t = faces.triangles[face];
    const bool reverse = !inverted.empty() && inverted[face] != 0;
    return {faces.positions[t[0]], faces.positions[t[reverse ? 2 : 1]], faces.positions[t[reverse ? 1 : 2]]};
  }
};

/// The faces of sites with the orientation that signs use. Valid for the lifetime of the sites.
[[nodiscard]] inline OrientedFaces oriented_faces(const sites::SitesData& sites) {
  return {sites.face_tree(), sites.inverted};
}

}  // namespace sdm::inside
