// A sphere.
#pragma once

#include <sdm/mesh.h>

namespace sdm::scenes {

/// An octahedron whose faces are subdivided 1:4 `cuts` times.
[[nodiscard]] Mesh ball(const Vec3& centre, double radius, int cuts);

}  // namespace sdm::scenes
