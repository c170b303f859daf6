// Cloth by extended position-based dynamics: M. Macklin, M. Müller and N. Chentanez, "XPBD: Position-Based
// Simulation of Compliant Constrained Dynamics" (2016), with substeps of one iteration (M. Macklin et al.,
// "Small Steps in Physics Simulation", 2019).
#pragma once

#include <sdm/mesh_edit.h>
#include <sdm/sites.h>

#include <span>
#include <vector>

#include "scenes/spatial_hash.h"

namespace sdm::scenes {

/// A square of n × n particles of mass 1, connected by springs along rows, columns and diagonals; springs
/// between every second particle of a row or column resist bending.
class Cloth {
 public:
  /// A square of this side length in the plane z = 0, centred at the origin.
  Cloth(std::uint32_t n, double side);

  /// The mesh at rest. Vertex y·n + x is the particle of column x and row y; tears add copies of vertices.
  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] std::span<Vec3> positions() { return positions_; }
  /// The minimum distance, maintained by contacts, between particles and of particles to solids.
  [[nodiscard]] double thickness() const { return thickness_; }
  /// Advances by dt seconds under gravity, with contacts with the solids and with the cloth itself.
  void step(double dt, std::span<const Sites> solids);
  /// Keeps a particle where it is.
  void pin(std::uint32_t particle) { mobility_[particle] = 0; }
  /// Tears where edges are longer than `limit` times their length at rest, the longest first: at an end of
  /// such an edge, the faces on the far side get a copy of the particle. Returns the edit of the mesh, empty
  /// if nothing tears.
  MeshEdit tear(double limit);

 private:
  struct Spring {
    std::uint32_t a, b;
    double length, compliance;
    /// Particles between the ends; kNone twice for an edge of the mesh. Without its surface around, the
    /// spring disappears.
    std::array<std::uint32_t, 2> across{kNone, kNone};
  };
  void add_spring(std::uint32_t a, std::uint32_t b, double compliance,
                  const std::array<std::uint32_t, 2>& across);
  [[nodiscard]] bool split(std::uint32_t particle, const Vec3& direction, MeshEdit& edit);
  void reconnect_springs(std::uint32_t particle, std::uint32_t copy);
  void solve_springs(double dt);
  void resolve_self_contacts();
  void resolve_contacts(const Sites& solid);

  Mesh mesh_;
  double thickness_;
  std::vector<Spring> springs_;
  SpatialHash hash_;
  std::vector<Vec3> positions_, previous_, velocities_;
  std::vector<double> mobility_;  ///< inverse masses: 1, or 0 for pinned particles
};

}  // namespace sdm::scenes
