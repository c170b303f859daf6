// The same shape with more triangles.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>

namespace sdm::bench {

/// Cuts each triangle into parts² and moves the vertices at random, always the same, by up to `noise` edges
/// of the result, as scanners do: nothing stays flat. Texture coordinates are dropped.
[[nodiscard]] Mesh refine_mesh(const Mesh& mesh, std::uint32_t parts, double noise);

}  // namespace sdm::bench
