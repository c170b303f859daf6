// The same shape with more triangles.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>

namespace sdm::bench {

/// Divides each triangle into parts² triangles, and moves each coordinate of the vertices by pseudorandom
/// noise of up to `noise` mean edge lengths, as in scans, so that nothing stays flat. Drops texture
/// coordinates.
[[nodiscard]] Mesh refine_mesh(const Mesh& mesh, std::uint32_t parts, double noise);

}  // namespace sdm::bench
