// Two meshes, and the results of a search between them.
#pragma once

#include <sdm/sites.h>

#include <array>

#include "geometry/affine.h"
#include "sites/bounding_cylinders.h"
#include "sites/sites_data.h"

namespace sdm::pairs {

/// A face of each of two meshes.
using FacePair = std::array<std::uint32_t, 2>;
inline constexpr FacePair kNoFaces{kNone, kNone};

/// O1 in place, and O2 moved by `pose`. No vertices are copied.
struct MeshPair {
  const sites::SitesData &o1, &o2;
  Affine pose{};
  /// Bounds on the nodes of O1 and O2 that make searches shorter, and change no result. Null: none.
  std::array<const sites::CylinderTree*, 2> cylinders{};
  [[nodiscard]] bool has_cylinders() const {
    const auto known = [](const sites::CylinderTree* tree) {
      return tree != nullptr && !tree->nodes.empty();
    };
    return known(cylinders[0]) && known(cylinders[1]);
  }

  /// A vertex of O2, posed. Compiled only once, without fused operations: all code must get the same bits.
  [[nodiscard]] Vec3 point2(std::uint32_t vertex) const;
  /// The corners of a face, of the same bits.
  [[nodiscard]] Corners face1(std::uint32_t face) const;
  [[nodiscard]] Corners face2(std::uint32_t face) const;
};

/// The closest points of two surfaces.
struct Separation {
  double distance = kInfinity;  ///< |point2 − point1|, to rounding
  bool intersecting = false;    ///< decided exactly; if so the distance is 0 and both points are one
  Vec3 point1{}, point2{};      ///< with O2 posed
  std::uint32_t face1 = kNone,
                face2 = kNone;  ///< faces that contain the points; kNone: nothing within the requested bound
};

}  // namespace sdm::pairs
