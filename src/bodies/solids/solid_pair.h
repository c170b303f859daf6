// Two bodies of which one at least is no mesh, or has a margin: their distances by cores and radii.
#pragma once

#include <sdm/bounds.h>

#include <optional>

#include "bodies/convex/difference_hull.h"
#include "bodies/solids/core_distance.h"
#include "bodies/solids/mesh_distance.h"
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
};

/// The distance of the surfaces: bounds, and points at that distance, if known.
struct SurfaceDistance {
  double lower = 0, upper = 0;
  std::optional<std::array<Vec3, 2>> closest{};
};

/// Memory that pairs reuse; results do not depend on it.
struct SolidWorkspace {
  convex::ExitWorkspace exit;
  std::vector<double> farthest;    ///< of each part of a mesh
  std::vector<FaceDistance> near;  ///< faces
};

/// Two bodies in their poses, which must outlive this object; not both half-spaces, which throw sdm::Error.
/// Each answer is found when it is first asked for.
///
/// The surface of a solid with the core K and the radius r is where d(x) = r, d the signed distance from K,
/// and the distance of x from it is |d(x) − r|: all results are those of cores, with the radii subtracted
/// once, here.
class SolidPair {
 public:
  SolidPair(const shape::PosedBody& o1, const shape::PosedBody& o2, SolidWorkspace& workspace);

  /// relation().colliding, mostly in less time.
  [[nodiscard]] bool colliding();
  [[nodiscard]] const Relation& relation();
  [[nodiscard]] const SurfaceDistance& surfaces();
  /// The faces of relation().point1 and point2; kNone where a body has none.
  [[nodiscard]] std::array<std::uint32_t, 2> faces();
  /// The penetration depth of bodies that collide.
  [[nodiscard]] BoundedLength depth();
  /// The diagonal of the box of both; of a half-space and another one, that of the other one.
  [[nodiscard]] double size() const { return size_; }

 private:
  [[nodiscard]] bool convex(int body) const {
    return cores_[body].kind() != CoreKind::mesh || cores_[body].convex() != nullptr;
  }
  [[nodiscard]] bool both_convex() const {
    return convex(0) && convex(1) && !half_space(0) && !half_space(1);
  }
  [[nodiscard]] bool half_space(int body) const { return cores_[body].kind() == CoreKind::half_space; }
  [[nodiscard]] const QuickDistance& quick();
  [[nodiscard]] double distance_to(int body, const Vec3& p);
  [[nodiscard]] bool extends_beyond(int body, double radius, int from, double from_radius) const;
  [[nodiscard]] std::array<double, 2> farthest_of(int body, int from);
  [[nodiscard]] Relation of_half_space(int half_space);
  [[nodiscard]] Relation of_convex();
  [[nodiscard]] Relation of_mesh(int mesh);
  [[nodiscard]] SurfaceDistance between_surfaces();
  [[nodiscard]] SurfaceDistance beside_half_space(int half_space) const;
  [[nodiscard]] SurfaceDistance of_nested();
  [[nodiscard]] SurfaceDistance beside_mesh(int mesh);
  [[nodiscard]] double between_parts(int mesh);
  [[nodiscard]] BoundedNumber depth_into(int outer);
  [[nodiscard]] BoundedLength depth_of_mesh(int mesh);

  std::array<const shape::PosedBody*, 2> bodies_;
  std::array<PosedCore, 2> cores_;
  SolidWorkspace& workspace_;
  double size_ = 0;
  std::optional<QuickDistance> quick_;  // of the cores of two convex bodies
  std::optional<Relation> relation_;
  std::optional<SurfaceDistance> surfaces_;
  std::uint32_t nearest_face_ = kNone;  // of a mesh that is not convex, with its relation
};

/// Whether bodies are compared by a SolidPair.
[[nodiscard]] inline bool are_solid_pair(const shape::PosedBody& o1, const shape::PosedBody& o2) {
  return o1.body().rounded() || o2.body().rounded();
}

}  // namespace sdm::solids
