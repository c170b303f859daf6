// The core of a body in its pose, and its support function.
#pragma once

#include <cstdint>

#include "bodies/convex/convex_mesh.h"
#include "bodies/shape/posed_body.h"

namespace sdm::solids {

/// A convex core in space. Of a mesh that is not convex, it is the convex hull.
class PosedCore {
 public:
  explicit PosedCore(const shape::PosedBody& body);
  /// The core that is a point.
  explicit PosedCore(const Vec3& point) : kind_(CoreKind::axis), centre_(point) {}
  /// A core of that axis, of length 1, without a radius.
  PosedCore(const Vec3& centre, const Vec3& axis, double half_length, double disc)
      : kind_(CoreKind::axis), centre_(centre), half_(half_length * axis), axis_(axis), disc_(disc) {}
  /// A triangle, without a radius.
  PosedCore(const Vec3& a, const Vec3& b, const Vec3& c) : corners_{a, b, c}, triangle_(true) {}

  /// A point of the core with the largest u·x, |u| = 1. `near`: a vertex that is near it, or kNone; it
  /// receives that vertex. Not of half-spaces.
  [[nodiscard]] Vec3 support(const Vec3& u, std::uint32_t& near) const;
  [[nodiscard]] Vec3 support(const Vec3& u) const {
    std::uint32_t near = kNone;
    return support(u, near);
  }
  /// Returns the core translated.
  [[nodiscard]] PosedCore moved(const Vec3& by) const;

  [[nodiscard]] CoreKind kind() const { return kind_; }
  [[nodiscard]] bool thin() const { return triangle_ || (kind_ == CoreKind::axis && disc_ == 0); }
  [[nodiscard]] bool point() const { return thin() && !triangle_ && half_ == Vec3{}; }
  [[nodiscard]] const Vec3& centre() const { return centre_; }
  /// The vector from the middle of the axis to an end.
  [[nodiscard]] const Vec3& half() const { return half_; }
  [[nodiscard]] const Vec3& axis() const { return axis_; }  ///< of length 1; also where half() is 0
  [[nodiscard]] double disc() const { return disc_; }
  [[nodiscard]] double radius() const { return radius_; }
  /// A half-space is the set of all x with normal · x ≤ offset.
  [[nodiscard]] const Vec3& normal() const { return axis_; }
  [[nodiscard]] double offset() const { return offset_; }
  /// The convex mesh; null for others.
  [[nodiscard]] const convex::ConvexMesh* convex() const { return convex_; }
  [[nodiscard]] const shape::PosedBody& body() const { return *body_; }

 private:
  CoreKind kind_ = CoreKind::mesh;
  Vec3 centre_{}, half_{}, axis_{0, 0, 1};
  double disc_ = 0, radius_ = 0, offset_ = 0;
  const convex::ConvexMesh* convex_ = nullptr;
  const shape::PosedBody* body_ = nullptr;
  Vec3 moved_{};
  std::array<Vec3, 3> corners_{};
  bool triangle_ = false;
};

}  // namespace sdm::solids
