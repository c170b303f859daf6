// The distance of the surface of a mesh from a convex core, by the tree of the mesh.
#pragma once

#include <vector>

#include "bodies/solids/core_distance.h"
#include "bodies/solids/posed_core.h"

namespace sdm::solids {

/// A face, and the point of it and that of the core that are closest, in space. The distance is 0 if they
/// have a point in common, without points and normal. The normal is away from the core.
struct FaceDistance : CoreDistance {
  std::uint32_t face = kNone;
};

/// The face of a mesh that is nearest to a core, and its distance, at most `most`; no face if all are
/// farther. Cost: logarithmic where few faces are nearly as near.
[[nodiscard]] FaceDistance nearest_face(const shape::PosedBody& mesh, const PosedCore& core,
                                        double most = kInfinity);

/// All faces within that distance of a core, in increasing order.
void faces_within(const shape::PosedBody& mesh, const PosedCore& core, double distance,
                  std::vector<FaceDistance>& found);

}  // namespace sdm::solids
