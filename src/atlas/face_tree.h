// The AABB tree of a surface, one face a leaf.
#pragma once

#include "atlas/surface_impl.h"

namespace sdm {

/// The tree over the faces that own a texel, built at the first call; its boxes are those of that build.
/// Engines copy it and refit it in the frame they work in. Cost: O(n log n), then none.
[[nodiscard]] const AabbTree& face_tree(const Surface::Impl& surface);

}  // namespace sdm
