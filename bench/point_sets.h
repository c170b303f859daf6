// Points whose closest points benchmarks search.
#pragma once

#include <sdm/mesh.h>
#include <sdm/types.h>

#include <cstddef>
#include <span>
#include <vector>

namespace sdm::bench {

/// A distribution of points about a mesh whose longest side is 1, in no order unless stated.
struct PointSet {
  const char *name, *description;
  std::vector<Vec3> (*points)(const Mesh& mesh, std::size_t count);
};
[[nodiscard]] std::span<const PointSet> point_sets();

/// Uniform in a box 1.5 times as large as that of the mesh, about its centre.
[[nodiscard]] std::vector<Vec3> points_around_box(const Mesh& mesh, std::size_t count);

}  // namespace sdm::bench
