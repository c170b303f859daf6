// Shapes of Coal, and queries of two of them.
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>

#include <memory>
#include <vector>

namespace coal {
class CollisionGeometry;
}

namespace sdm::bench {

using CoalShape = std::shared_ptr<const coal::CollisionGeometry>;

[[nodiscard]] CoalShape coal_sphere(double radius);
[[nodiscard]] CoalShape coal_capsule(double radius, double length);
[[nodiscard]] CoalShape coal_cylinder(double radius, double length);
[[nodiscard]] CoalShape coal_box(const Vec3& sides);
[[nodiscard]] CoalShape coal_half_space(const Vec3& normal, double offset);
[[nodiscard]] CoalShape coal_hull(const Mesh& mesh);
/// A hierarchy of oriented boxes and rectangle-swept spheres.
[[nodiscard]] CoalShape coal_mesh(const Mesh& mesh);

/// Two shapes, the second in one of several poses. What Coal can know before a query is found here, not by
/// it.
class CoalPair {
 public:
  /// `warm`: a search starts from what the query before it left.
  CoalPair(CoalShape o1, CoalShape o2, const std::vector<Transform>& poses, bool warm);
  ~CoalPair();

  /// The distance, with closest points; where the shapes overlap, at most 0.
  [[nodiscard]] double distance(std::size_t pose) const;
  /// The same, but where the shapes overlap, minus the length of the shortest way out.
  [[nodiscard]] double signed_distance(std::size_t pose) const;
  [[nodiscard]] bool collide(std::size_t pose) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::bench
