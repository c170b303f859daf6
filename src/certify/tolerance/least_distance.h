// The face of A that is closest to B.
#pragma once

#include <sdm/mesh.h>

#include "certify/hausdorff/matching.h"
#include "geometry/triangle_pair.h"
#include "sites/sites_data.h"

namespace sdm::tolerance {

struct LeastDistance {
  double value = 0;                                  ///< to rounding
  Vec3 point{}, closest{};                           ///< of A and of B
  std::uint32_t face = kNone, closest_face = kNone;  ///< kNone: no face is closer than `most`
};

/// Returns the least distance of the faces of A from B, or from those that `matching` allows for each, if it
/// is below `most`, otherwise `most`. Cost: for each face of A a search of the faces of B that are closer;
/// all cores.
[[nodiscard]] LeastDistance least_distance(const Mesh& a, const sites::SitesData& b, double most,
                                           const hausdorff::Matching* matching = nullptr);

}  // namespace sdm::tolerance
