// The same shape with fewer triangles.
#pragma once

#include <sdm/mesh.h>

#include <cstddef>

namespace sdm::bench {

/// Collapses edges (by meshoptimizer) until at most `triangles` are left. The topology stays: where it allows
/// no further collapse, more are left. Texture coordinates are dropped.
[[nodiscard]] Mesh reduce_mesh(const Mesh& mesh, std::size_t triangles);

}  // namespace sdm::bench
