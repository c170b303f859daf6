// Mesh simplification.
#pragma once

#include <sdm/mesh.h>

#include <cstddef>

namespace sdm::scenes {

/// Collapses edges (meshoptimizer) until at most `triangles` are left, or more where no further collapse
/// would preserve the topology. Pairs of coincident faces, which collapses leave at thin parts, are removed,
/// and so are texture coordinates.
[[nodiscard]] Mesh reduce_mesh(const Mesh& mesh, std::size_t triangles);

}  // namespace sdm::scenes
