// Two bodies of which one at least is no mesh, or has a margin: their distances by cores and radii.
#pragma once

#include <sdm/bounds.h>

#include <optional>

#include "bodies/convex/difference_hull.h"
#include "bodies/solids/posed_core.h"

namespace sdm::solids {

/// Where two bodies are.
struct Relation {
  bool colliding = false;
  /// Whether `gap` is the signed distance of both bodies: if negative, the shortest way out. Otherwise a mesh
  /// is not convex, and gap is the signed distance of its surface from the other one's core, less the radius.
  bool signed_distance = true;
  double gap = 0;
  double error = 0;         ///< of the gap
  Vec3 normal{};            ///< of length 1: moving O1 along it separates it from O2; 0 if unknown
  Vec3 point1{}, point2{};  ///< on both surfaces, point1 − point2 = gap · normal, if the normal is known
  double surface_lower = 0, surface_upper = 0;   ///< bounds on the distance of the surfaces
  std::optional<std::array<Vec3, 2>> closest{};  ///< points of the surfaces at that distance, if known
  std::array<std::uint32_t, 2> faces{kNone, kNone};
};

/// Two bodies in their poses, which must outlive this object; not both half-spaces, which throw sdm::Error.
///
/// The surface of a solid with the core K and the radius r is where d(x) = r, d the signed distance from K,
/// and the distance of x from it is |d(x) − r|: all results are those of cores, with the radii subtracted
/// once, here.
class SolidPair {
 public:
  SolidPair(const shape::PosedBody& o1, const shape::PosedBody& o2, convex::ExitWorkspace& workspace);

  /// The distances, and whether they collide.
  [[nodiscard]] Relation relation();
  /// The penetration depth of bodies that collide with that relation.
  [[nodiscard]] BoundedLength depth(const Relation& relation);
  /// The diagonal of the box of both; of a half-space and another one, that of the other one.
  [[nodiscard]] double size() const { return size_; }

 private:
  [[nodiscard]] bool convex(int body) const {
    return cores_[body].kind() != CoreKind::mesh || cores_[body].convex() != nullptr;
  }
  [[nodiscard]] double distance_to(int body, const Vec3& p);
  [[nodiscard]] std::array<double, 2> farthest_of(int body, int from);
  [[nodiscard]] Relation of_half_space(int half_space);
  [[nodiscard]] Relation of_convex();
  [[nodiscard]] Relation of_mesh(int mesh);
  void find_nesting(Relation& relation);
  [[nodiscard]] double between_parts(int mesh);
  [[nodiscard]] BoundedNumber depth_into(int outer, const Relation& relation);
  [[nodiscard]] BoundedLength depth_of_mesh(int mesh, const Relation& relation);

  std::array<const shape::PosedBody*, 2> bodies_;
  std::array<PosedCore, 2> cores_;
  convex::ExitWorkspace& workspace_;
  double size_ = 0;
};

/// Whether bodies are compared by a SolidPair.
[[nodiscard]] inline bool are_solid_pair(const shape::PosedBody& o1, const shape::PosedBody& o2) {
  return o1.body().rounded() || o2.body().rounded();
}

}  // namespace sdm::solids
