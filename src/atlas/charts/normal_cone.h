// The cone that a set of normals spans: whether some axis is within a given angle of all of them.
#pragma once

#include <sdm/types.h>

#include <optional>
#include <span>
#include <vector>

namespace sdm::atlas {

/// A set of unit vectors, reduced to the extreme rays of the convex cone that they span. Vectors x with
/// x·axis ≥ cos θ |x| form a convex cone too (θ < 90°), so a cap contains the set if it contains the extreme
/// rays.
struct NormalCone {
  Vec3 axis{};  ///< unit, close to the centre of the smallest cap
  std::vector<Vec3> rays;
};

/// The cone of `normals`, all of which are well inside the half-space of `axis`. The largest angle between a
/// normal and the cone's axis is at most the largest one to `axis`. Cost: O(n log n).
[[nodiscard]] NormalCone spanned_cone(std::span<const Vec3> normals, const Vec3& axis);

/// The cone of both, if an axis is found with ray·axis ≥ cos_angle for all of the rays.
[[nodiscard]] std::optional<NormalCone> join(const NormalCone& a, const NormalCone& b, double cos_angle);

}  // namespace sdm::atlas
