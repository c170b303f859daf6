// The surface where a function is zero.
#pragma once

#include <sdm/mesh.h>

#include <functional>

namespace sdm {

/// The zero level of `field` within a box, on a grid of cubes of side `spacing` cut into tetrahedra: closed,
/// manifold, faces towards positive values, if the field is positive on the box's border. Vertices are where
/// the field, linear along edges, is zero. Cost: one value of the field a grid point.
[[nodiscard]] Mesh level_set(const std::function<double(const Vec3&)>& field, const Box& box, double spacing);

}  // namespace sdm
