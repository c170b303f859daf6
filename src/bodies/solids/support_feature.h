// The face, edge or vertex of a convex body that is farthest in a direction.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bodies/convex/convex_mesh.h"
#include "bodies/shape/posed_body.h"
#include "bodies/solids/posed_core.h"

namespace sdm::solids {

/// A plane across a direction, with coordinates.
struct ContactPlane {
  Vec3 origin{};
  std::array<Vec3, 2> axes{};
  double size = 0;  ///< of the bodies that are compared in it

  [[nodiscard]] Vec2 operator()(const Vec3& p) const {
    return {dot(axes[0], p - origin), dot(axes[1], p - origin)};
  }
};

/// The feature with which a convex solid touches a plane, or nearly so: at its farthest vertex, the face that
/// is most nearly parallel to the plane, with those that continue it, if it is so to 3 degrees; else the
/// edge; else the vertex. Seen in the plane, it is a convex polygon, a segment or a point. That of the flat
/// end of a cylinder is a polygon in its circle; a half-space has no corners, and is everywhere.
class SupportFeature {
 public:
  struct Corner {
    Vec2 at{};
    std::uint32_t vertex = kNone;  ///< its number in the mesh
  };
  /// A point of the surface, in space.
  struct Above {
    Vec3 point{};
    SurfacePoint on{};
  };

  /// Finds that of a body which body().has_support() says, farthest along `up`, |up| = 1, a normal of
  /// the plane.
  void find(const shape::PosedBody& body, const Vec3& up, const ContactPlane& plane);

  /// Counter-clockwise in the plane; none is within rounding of the line between its neighbours.
  [[nodiscard]] std::span<const Corner> corners() const { return corners_; }
  /// A number of a corner below 2¹⁴.
  [[nodiscard]] std::uint64_t number(std::uint32_t vertex) const;
  /// Whether it is the plane of a half-space.
  [[nodiscard]] bool everywhere() const { return core_ && core_->kind() == CoreKind::half_space; }
  /// The point of the feature above a point of the plane; the nearest one, to rounding, if that is beside it.
  [[nodiscard]] Above above(const Vec2& at) const;
  [[nodiscard]] Above at_corner(std::size_t corner) const;

 private:
  void find_core(const Vec3& up);
  void add_corner(const Vec3& p, std::uint32_t number);
  [[nodiscard]] Above above_core(const Vec2& at) const;
  void find_edge(std::uint32_t vertex, const Vec3& up);
  void find_faces(std::uint32_t best);
  void find_outline();
  [[nodiscard]] Vec3 point(std::uint32_t vertex) const;  // in space
  [[nodiscard]] Above above_face(const Vec2& at) const;
  [[nodiscard]] Above above_edge(const Vec2& at) const;
  [[nodiscard]] Above between(std::uint32_t face, const Vec3& weights) const;

  const shape::PosedBody* body_ = nullptr;
  const convex::ConvexMesh* convex_ = nullptr;
  ContactPlane plane_;
  std::optional<PosedCore> core_;  // of a body without a mesh
  std::vector<Vec3> core_points_;  // of its corners, on the surface
  Vec3 up_{}, lift_{};             // lift_: from the core to the surface
  bool has_area_ = false;
  std::vector<std::uint32_t> faces_;  // all of them, or one at the edge or the vertex
  std::vector<std::uint32_t> marks_;  // of the faces that were found, the number of the search
  std::uint32_t search_ = 0;
  std::vector<Corner> places_, corners_;
};

}  // namespace sdm::solids
