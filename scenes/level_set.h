// Isosurfaces.
#pragma once

#include <sdm/mesh.h>

#include <functional>

namespace sdm::scenes {

/// Extracts the surface where `field` is zero within a box, by marching tetrahedra on a grid of cubes of side
/// `spacing`. The surface is closed, manifold, and oriented towards positive values, provided that the field
/// is positive on the boundary of the box. `field` must be safe to call from several threads. Cost: one
/// evaluation of the field per grid point.
[[nodiscard]] Mesh level_set(const std::function<double(const Vec3&)>& field, const Box& box, double spacing);

}  // namespace sdm::scenes
