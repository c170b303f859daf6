// Distances and insides by CGAL, and distances by brute force: independent of the code under test.
#pragma once

#include <sdm/mesh.h>

#include <memory>
#include <vector>

namespace sdm::oracle {

/// Distance to a mesh by CGAL's AABB tree. Thin faces, whose height is below 1e-8 of the mesh's diagonal, and
/// faces without area are represented by their edges, which are nowhere farther than this height.
class CgalDistance {
 public:
  explicit CgalDistance(const Mesh& mesh);
  ~CgalDistance();
  [[nodiscard]] double operator()(const Vec3& point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether a point lies inside a closed mesh: the parity of crossings along a ray, by CGAL's
/// Side_of_triangle_mesh.
class CgalInside {
 public:
  explicit CgalInside(const Mesh& mesh);
  ~CgalInside();
  [[nodiscard]] bool operator()(const Vec3& point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Distances to the nearest of some points, by CGAL's k-d tree.
class CgalPoints {
 public:
  explicit CgalPoints(const std::vector<Vec3>& points);
  ~CgalPoints();
  [[nodiscard]] double distance(const Vec3& point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Point–segment and point–triangle distance in extended precision; degenerate ones included.
[[nodiscard]] double distance(const Vec3& point, const Vec3& a, const Vec3& b);
[[nodiscard]] double distance(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c);

/// The least of the distances to all triangles of a mesh.
[[nodiscard]] double brute_force(const Mesh& mesh, const Vec3& point);

/// How many times a closed mesh, with its faces as they are oriented, winds around a point: the sum of the
/// solid angles of all triangles.
[[nodiscard]] int winding_number(const Mesh& mesh, const Vec3& point);

}  // namespace sdm::oracle
