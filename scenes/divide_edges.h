// The same shape with triangles of about one size.
#pragma once

#include <sdm/mesh.h>

#include <cstddef>

namespace sdm::scenes {

/// Divides edges at their middle until about this many triangles are left; edges end up at most twice as long
/// as others, slivers of the mesh aside. Faces that share an edge share its middle. Drops texture
/// coordinates. Cost: linear in the result, some twenty times.
[[nodiscard]] Mesh divide_edges(const Mesh& mesh, std::size_t triangles);

}  // namespace sdm::scenes
