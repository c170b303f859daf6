// Closest points among the faces that face the same way as the query.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "closest/facing/normal_cones.h"
#include "sites/sites_data.h"

namespace sdm::facing {

/// Throws sdm::Error unless an angle in degrees is above 0 and at most 180.
void check_angle(double angle);

/// Normals within an angle; for 90° less than that.
class FacingAngle {
 public:
  /// `degrees` as of check_angle().
  explicit FacingAngle(double degrees);

  /// `cosine`: of two unit vectors.
  [[nodiscard]] bool allows(double cosine) const {
    return right_angle_ ? cosine > 0 : cosine >= least_cosine_;
  }

 private:
  bool right_angle_;
  double least_cosine_;
};

/// The result for a query. A point on several allowed faces is one of the surface that they form: its normal
/// is their sum, at a vertex weighted by their angles.
struct Match {
  ClosestPoint closest{};  ///< its face is allowed
  bool behind = false;     ///< (query − closest point) · normal of the match < 0
  bool unmatched = false;  ///< no face is allowed, at any distance
};

class FacingSearch {
 public:
  /// `angle` as of check_angle(). The sites must outlive this. Cost: that of normal_bounds_of().
  FacingSearch(const sites::SitesData& sites, double angle);

  /// Whether the normal of a face is within the angle of a unit vector; for 90° less than that.
  [[nodiscard]] bool allows(const Vec3& normal, std::uint32_t face) const {
    return has_normal(sites_, face) && angle_.allows(dot(sites_.normals.face[face], normal));
  }

  /// Whether there may be an allowed face below a node of the tree.
  [[nodiscard]] bool may_allow(std::uint32_t node, const Vec3& normal) const {
    return angle_.allows(largest_cosine(bounds_.cones[node], normal));
  }

  /// Returns the faces that are allowed for a unit vector, if they are fewer than about the root of all
  /// faces. A search of the tree, where few leaves have such a face, would visit most of it. Cost: by these
  /// faces, mostly; the first call for a shape builds a tree, O(n log n).
  [[nodiscard]] std::optional<std::vector<std::uint32_t>> few_allowed(const Vec3& normal) const;

  /// A search that visits more nodes is continued among few_allowed().
  static constexpr std::size_t kManyNodes = 1024;

  /// `normal`: of the query, unit length or 0. `closest`: the closest point of all faces, which is the result
  /// if it lies on an allowed one; none if nothing is within max_distance.
  [[nodiscard]] Match match(const Vec3& query, const Vec3& normal, double max_distance,
                            const ClosestPoint& closest) const;

 private:
  /// Allowed faces, wherever they are, `most` at the most.
  [[nodiscard]] std::vector<std::uint32_t> some_allowed(const Vec3& normal, std::size_t most) const;
  [[nodiscard]] ClosestPoint closest_allowed(const Vec3& query, const Vec3& normal,
                                             double max_distance) const;
  /// The faces around the site of a point.
  [[nodiscard]] std::span<const std::uint32_t> faces_of(const ClosestPoint& closest) const;
  /// The normal of the allowed faces at a point; `face` becomes the first of them, kNone if there is none.
  [[nodiscard]] Vec3 normal_at(const ClosestPoint& closest, const Vec3& normal, std::uint32_t& face) const;

  const sites::SitesData& sites_;
  const NormalBounds& bounds_;
  FacingAngle angle_;
};

}  // namespace sdm::facing
