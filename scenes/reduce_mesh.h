// Mesh simplification.
#pragma once

#include <sdm/mesh.h>

#include <cstddef>

namespace sdm::scenes {

/// Collapses edges (meshoptimizer) until at most `triangles` remain, or more if no further collapse preserves
/// the topology. Removes pairs of coincident faces, which collapses leave at thin parts, and texture
/// coordinates.
[[nodiscard]] Mesh reduce_mesh(const Mesh& mesh, std::size_t triangles);

}  // namespace sdm::scenes
