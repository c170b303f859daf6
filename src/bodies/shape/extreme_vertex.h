// The vertex of a surface that is farthest in a direction.
#pragma once

#include "sites/sites_data.h"

namespace sdm::shape {

struct ExtremeVertex {
  double along = 0;  ///< u·x
  Vec3 point{};      ///< x
};

/// The corner x of a face with the largest u·x, |u| = 1, in the frame of the mesh; or `known` if none is
/// farther. Cost: logarithmic where few vertices are nearly as far.
[[nodiscard]] ExtremeVertex extreme_vertex(const sites::SitesData& sites, const Vec3& u,
                                           const ExtremeVertex& known = {.along = -kInfinity});

}  // namespace sdm::shape
