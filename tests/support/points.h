// Points to test with.
#pragma once

#include <sdm/mesh.h>

#include <random>
#include <vector>

namespace sdm::test {

[[nodiscard]] Vec3 random_point(const Box& box, std::mt19937& random);
/// Uniform in area.
[[nodiscard]] std::vector<Vec3> random_surface_points(const Mesh& mesh, std::size_t count,
                                                      std::mt19937& random);
/// The diagonal of the box around both.
[[nodiscard]] double scene_diagonal(const Mesh& o1, const Mesh& o2);

}  // namespace sdm::test
