// Rigid bodies that fall, touch and come to rest: a solver on the contacts of MultiBodyQuery.
#pragma once

#include <sdm/multi_body_query.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "scenes/rotation.h"

namespace sdm::scenes {

/// The mass of a solid of density 1, its centre, and its inertia about that, as columns.
struct MassProperties {
  double mass = 0;
  Vec3 centre{};
  Matrix inertia{};
};
/// Of a closed mesh that faces outward, from its triangles.
[[nodiscard]] MassProperties mass_properties(const Mesh& mesh);

/// A body as it begins: in the frame of its mesh moved by `pose`, with a velocity.
struct RigidStart {
  Shape shape;
  Transform pose{};
  bool fixed = false;
  Vec3 velocity{}, spin{};
};

struct RigidSettings {
  double step = 1.0 / 240;
  Vec3 gravity{0, 0, -9.81};
  double friction = 0.5;
  double margin = 0.02;     ///< of contacts; bodies that approach by more in a step enter each other
  bool separating = false;  ///< by separating_contacts() in place of contacts()
  bool ignore_internal_edges = false;
  int most_sweeps = 2000;
};

/// Each step is implicit in the velocities u: Gauss–Seidel on the impulses of the contacts, projected on
/// those that push, until the velocities are settled. With the gap g of a contact after the last step, its
/// normal n and the step h, n·u ≥ −max(g, 0)/h; friction is Coulomb's. There is no damping, no sleeping, no
/// restitution and no push out of an overlap. As u = 0 meets all constraints, the best u has
///   ½ |u|² − h a·u ≤ ½ |u before|²  (in the metric of the masses, with the acceleration a),
/// so that the energy never rises. Between contacts a body turns by the implicit midpoint rule of Euler's
/// equations, which keeps its kinetic energy.
class RigidWorld {
 public:
  RigidWorld(const std::vector<RigidStart>& bodies, const RigidSettings& settings);

  void step();
  /// Kinetic and potential.
  [[nodiscard]] double energy() const;
  /// The largest speed of a point of a body.
  [[nodiscard]] double speed() const;
  [[nodiscard]] const Vec3& velocity(std::size_t body) const { return bodies_[body].velocity; }
  /// The largest upper bound on a penetration depth.
  [[nodiscard]] double penetration();
  [[nodiscard]] std::size_t contacts() const { return rows_.size(); }
  /// The number of sweeps of the last step.
  [[nodiscard]] int sweeps() const { return sweeps_; }
  [[nodiscard]] MultiBodyQuery& query() { return query_; }

 private:
  struct Body {
    double mass = 0, inverse_mass = 0;  // 0 if it is fixed
    Vec3 centre_in_mesh{}, centre{}, velocity{}, spin{};
    double radius = 0;                            // about the centre
    Matrix turn{}, inertia{}, inverse_inertia{};  // the inertia in the frame of the mesh
    Matrix inverse_in_space{};
  };
  // An impulse along an axis, of the first body of a contact and against the second.
  struct Axis {
    Vec3 along{};
    std::array<Vec3, 2> moment{}, turned{};  // arm × axis, and the spin by it
    double inverse = 0;                      // velocity along the axis by an impulse of 1
    double impulse = 0;
  };
  using Key = std::tuple<std::uint32_t, std::uint32_t, PartPair, std::uint64_t>;
  struct Row {
    std::array<Body*, 2> bodies{};
    std::array<Axis, 3> axes{};  // the normal first
    double allowed = 0;          // the speed at which the bodies may approach each other
    Key key;
  };

  void fall();
  void find_rows();
  void add_row(const PairContacts& pair, const Contact& contact);
  void start_from_last();
  [[nodiscard]] double sweep();
  [[nodiscard]] double kinetic_energy() const;
  static double speed_along(const Row& row, const Axis& axis);
  static void push(Row& row, Axis& axis, double impulse);
  [[nodiscard]] static Transform pose_of(const Body& body);

  RigidSettings settings_;
  MultiBodyQuery query_;
  std::vector<Body> bodies_;
  std::vector<Row> rows_;
  std::map<Key, std::array<double, 3>> last_;
  int sweeps_ = 0;
};

}  // namespace sdm::scenes
