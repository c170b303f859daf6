// The same shape with fewer triangles.
#pragma once

#include <sdm/mesh.h>

#include <cstddef>

namespace sdm {

/// Collapses edges (by meshoptimizer) until at most `triangles` are left. The topology stays: where it allows
/// no further collapse, more are left. Pairs of faces back to back, which collapses
/// leave at thin parts, are taken out. Texture coordinates are dropped.
[[nodiscard]] Mesh reduce_mesh(const Mesh& mesh, std::size_t triangles);

}  // namespace sdm
