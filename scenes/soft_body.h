// Soft bodies by shape matching: M. Müller, B. Heidelberger, M. Teschner and M. Gross, "Meshless Deformations
// Based on Shape Matching" (2005).
#pragma once

#include <sdm/mesh.h>

#include <span>
#include <vector>

#include "scenes/rotation.h"

namespace sdm::scenes {

/// Every vertex is a particle of mass 1. Overlapping clusters of particles are pulled towards the best rigid
/// fit of their rest shape; the pulls add up to no force and no torque.
class SoftBody {
 public:
  struct Material {
    double stiffness = 0.2;        ///< the fraction of the way to the rest shape covered by a step, in (0, 1]
    double cluster_radius = 0.15;  ///< smaller clusters: softer overall, equally stiff within a cluster
    std::size_t clusters = 150;    ///< minimum; more are added until they cover all vertices
  };

  /// The mesh is the rest shape. Velocities are in m/s and rad/s, about the centre of the vertices.
  SoftBody(const Mesh& mesh, const Material& material, const Vec3& velocity, const Vec3& angular_velocity);

  [[nodiscard]] std::span<const Vec3> positions() const { return positions_; }
  /// The displacement of a vertex since begin_step().
  [[nodiscard]] Vec3 displacement(std::uint32_t v) const { return positions_[v] - previous_[v]; }
  void move(std::uint32_t v, const Vec3& by) { positions_[v] += by; }

  // A step of position-based dynamics: begin_step(), any number of move() and match_shapes(), end_step().
  void begin_step(double dt);
  void match_shapes();
  void end_step(double dt);

 private:
  struct Cluster {
    std::vector<std::uint32_t> vertices;
    std::vector<Vec3> rest;  ///< rest positions relative to their centre
    Matrix rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  };
  void add_cluster(const std::vector<std::vector<std::uint32_t>>& neighbours, std::uint32_t seed,
                   double radius);

  double stiffness_;
  std::vector<Cluster> clusters_;
  std::vector<double> masses_;  ///< of a vertex in each of its clusters: 1 / number of clusters
  std::vector<Vec3> positions_, previous_, velocities_, pulls_;
};

}  // namespace sdm::scenes
