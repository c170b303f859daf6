// Soft bodies by shape matching: M. Müller, B. Heidelberger, M. Teschner and M. Gross, "Meshless Deformations
// Based on Shape Matching" (2005).
#pragma once

#include <sdm/mesh.h>

#include <span>
#include <vector>

#include "scene/rotation.h"

namespace sdm {

/// Every vertex is a particle of mass 1. Overlapping clusters of them seek their shape at rest; what they
/// pull adds up to no force and no torque.
class SoftBody {
 public:
  struct Material {
    double stiffness = 0.2;        ///< share of the way to the shape at rest that a step goes, in (0, 1]
    double cluster_radius = 0.15;  ///< smaller: softer as a whole, yet as firm within a cluster
    std::size_t clusters = 150;    ///< at least
  };

  /// At rest in the shape of the mesh, and moving.
  SoftBody(const Mesh& mesh, const Material& material, const Vec3& velocity, const Vec3& angular_velocity);

  [[nodiscard]] std::span<const Vec3> positions() const { return positions_; }
  [[nodiscard]] std::span<const Vec3> velocities() const { return velocities_; }
  /// How far a vertex has come in this step.
  [[nodiscard]] Vec3 moved(std::uint32_t v) const { return positions_[v] - previous_[v]; }
  void move(std::uint32_t v, const Vec3& by) { positions_[v] += by; }

  // A step of position-based dynamics: begin, then move vertices and seek the shape, then end.
  void begin_step(double dt);
  void seek_shape();
  void end_step(double dt);

 private:
  struct Cluster {
    std::vector<std::uint32_t> vertices;
    std::vector<Vec3> rest;  ///< about their centre
    Matrix rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  };
  void add_cluster(const std::vector<std::vector<std::uint32_t>>& neighbours, std::uint32_t seed,
                   double radius);

  double stiffness_;
  std::vector<Cluster> clusters_;
  std::vector<double> shares_;  ///< of a vertex's mass in each of its clusters: 1 / their number
  std::vector<Vec3> positions_, previous_, velocities_, pulls_;
};

}  // namespace sdm
