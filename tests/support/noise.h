// Meshes as scanners deliver them.
#pragma once

#include <sdm/mesh.h>

namespace sdm::test {

/// Moves every vertex along its normal, and in all directions, by normally distributed lengths with these
/// standard deviations, in mean lengths of an edge. Bit-identical on every run.
[[nodiscard]] Mesh with_noise(Mesh mesh, double along_normals, double all_ways = 0);

}  // namespace sdm::test
