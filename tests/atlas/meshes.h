// Meshes to lay out.
#pragma once

#include <sdm/mesh.h>

#include <string>

namespace sdm::test {

[[nodiscard]] Mesh load(const std::string& name);

/// Triangles of any size and place; a tenth of them slivers, a tenth repeated, some without area.
[[nodiscard]] Mesh soup(std::size_t triangles, unsigned seed);
[[nodiscard]] Mesh moebius_strip(int segments);
/// A flat ring wound upwards slowly: seen from above it covers itself `turns` times.
[[nodiscard]] Mesh spiral_ramp(int turns, int segments);
/// A fan of slivers around one vertex.
[[nodiscard]] Mesh fan(int slivers);
/// A wavy height field over n² squares, with its ground plane as texture coordinates.
[[nodiscard]] Mesh height_field(int n);

}  // namespace sdm::test
