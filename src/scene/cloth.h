// Cloth by extended position-based dynamics: M. Macklin, M. Müller and N. Chentanez, "XPBD: Position-Based
// Simulation of Compliant Constrained Dynamics" (2016), in small steps of one iteration (Macklin et al.
// 2019).
#pragma once

#include <sdm/sites.h>

#include <span>
#include <vector>

#include "scene/spatial_hash.h"

namespace sdm {

/// A square of n × n particles of mass 1, held together by springs along rows, columns and diagonals; springs
/// that skip a particle resist bending.
class Cloth {
 public:
  /// `side` long, in the plane of x and y about the origin.
  Cloth(std::uint32_t n, double side);

  /// As it lies flat; vertex y·n + x.
  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] std::span<Vec3> positions() { return positions_; }
  /// How far apart particles keep, and the cloth above solids.
  [[nodiscard]] double thickness() const { return thickness_; }
  /// Falls for a time, on solids and on itself.
  void step(double dt, std::span<const Sites> solids);

 private:
  struct Spring {
    std::uint32_t a, b;
    double length, compliance;
  };
  void tie(std::uint32_t a, std::uint32_t b, double compliance);
  void pull(double dt);
  void keep_apart();
  void stay_outside(const Sites& solid);

  Mesh mesh_;
  double thickness_;
  std::vector<Spring> springs_;
  SpatialHash hash_;
  std::vector<Vec3> positions_, previous_, velocities_;
};

}  // namespace sdm
