// The search for the closest points of two convex solids by their support functions.
#pragma once

#include <array>
#include <cstdint>

#include "bodies/convex/convex_mesh.h"
#include "geometry/affine.h"

namespace sdm::convex {

/// The vertices of O1 and of O2 between which the closest points are; of bodies that overlap, four
/// differences around the origin.
struct Simplex {
  std::uint32_t count = 0;
  std::array<std::array<std::uint32_t, 2>, 4> vertices{};
  Vec3 away{};  ///< the unit vector from the closest point of O2 to that of O1, in the frame of O1
};

enum class Relation : std::uint8_t {
  unknown,  ///< nearly touching, or not decided within the steps
  apart,    ///< farther apart than asked for: along a direction, beyond rounding errors
  near,     ///< apart, and the simplex has the closest points, to rounding
  overlap   ///< a point is inside both, beyond rounding errors
};

struct SupportRequest {
  const ConvexMesh &o1, &o2;
  Affine pose;          ///< of O2 in the frame of O1
  double scale = 1;     ///< of the pose
  double beyond = 0;    ///< the search ends if the bodies are farther apart than this
  double rounding = 0;  ///< of a posed vertex
};

/// The vertex with the largest u·x, to rounding in double precision. `near`: that of a similar direction, or
/// kNone; it decides between equal ones. Cost: that of comparing all vertices, or of some neighbours.
[[nodiscard]] std::uint32_t farthest_vertex(const ConvexMesh& mesh, const Vec3& u,
                                            std::uint32_t near = kNone);

/// Gilbert, Johnson & Keerthi 1988: the point closest to the origin of simplices of differences x1 − x2, each
/// extended by the vertices that are farthest in its direction. `simplex`: that of a similar pose, or none;
/// it receives the last one. Cost: some steps, each that of comparing all vertices
/// of both.
[[nodiscard]] Relation search_by_supports(const SupportRequest& request, Simplex& simplex);

}  // namespace sdm::convex
