// The one-sided Hausdorff distance, independent of the code under test.
#pragma once

#include <sdm/mesh.h>

#include <array>

namespace sdm::oracle {

/// Bounds {lower, upper}, at most `precision` apart, by division of triangles whose bound is the distance at
/// their centre plus their radius. Distances are computed by brute force. Faces that repeat a corner are
/// ignored.
[[nodiscard]] std::array<double, 2> hausdorff_bounds(const Mesh& a, const Mesh& b, double precision);

/// The distance of a point and a triangle of any shape, in rational arithmetic, rounded to double.
[[nodiscard]] double exact_distance(const Vec3& point, const std::array<Vec3, 3>& corners);

/// CGAL's bounded_error_Hausdorff_distance, of manifold meshes: within the error of the truth.
[[nodiscard]] double cgal_hausdorff(const Mesh& a, const Mesh& b, double error);

}  // namespace sdm::oracle
