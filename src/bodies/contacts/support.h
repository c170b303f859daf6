// Faces that can carry a vertex or an edge of another body.
#pragma once

#include <span>

#include "bodies/shape/body.h"

namespace sdm::contacts {

/// How deep a face may be below the vertices and edges that it supports, relative to the smaller body.
inline constexpr double kSupportReach = 1.0 / 8;

/// A face, and the height above it, negative below.
struct Support {
  std::uint32_t face = kNone;
  double height = 0;
};

/// The sine of the small angle below.
inline constexpr double kPushSine = 0.05;

/// Whether a push along `normal` moves a vertex or an edge away without moving anything around it in the
/// opposite direction first: all `spokes`, from it to what is around it, are on this side of a plane with
/// this normal, but for a small angle. Otherwise something else of the body is in contact sooner. A corner
/// that is flush with the side of another box can be pushed up, but not sideways.
[[nodiscard]] inline bool can_push(const Vec3& normal, std::span<const Vec3> spokes) {
  for (const Vec3& spoke : spokes)
    if (dot(normal, spoke) < -kPushSine * norm(spoke)) return false;
  return true;
}

/// Whether a face can support anything: it is part of the boundary of a solid everywhere, and has a normal.
[[nodiscard]] bool is_support(const shape::Body& body, std::uint32_t face);

/// The face closest along its normal to a vertex above or below it, at most `max_depth` below and `margin`
/// above, that can push it. Cost: of the faces within both.
[[nodiscard]] Support support_of_vertex(const shape::Body& body, const Vec3& vertex,
                                        std::span<const Vec3> spokes, double margin, double max_depth);

/// The part of the line a + t·along, 0 ≤ t ≤ 1, that is above or below a face; `to` < `from` if none is.
struct Clip {
  double from = 0, to = 1;
};
[[nodiscard]] Clip clip_to_prism(const sites::SitesData& sites, std::uint32_t face, const Vec3& a,
                                 const Vec3& along, double margin, double max_depth);

}  // namespace sdm::contacts
