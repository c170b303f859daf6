// The evidence of the samples of a map, of all of them or by group.
#pragma once

#include <sdm/map.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sdm::summary {

/// A partition of the faces of a surface: `of_face[f]` is the number of the group of face f, below `count`,
/// or kNone. Empty: all faces are group 0.
struct FaceGroups {
  std::span<const std::uint32_t> of_face{};
  std::size_t count = 1;

  [[nodiscard]] std::uint32_t group(std::uint32_t face) const { return of_face.empty() ? 0 : of_face[face]; }
};

/// Returns the evidence of each group, from the texels and the vertices of its faces, with an infinite error
/// bound. Throws sdm::Error if the map or the distances belong to another surface. Cost: linear in texels and
/// faces, for all groups together.
[[nodiscard]] std::vector<Evidence> evidence_of_groups(const Surface& surface, const DistanceMap& map,
                                                       std::span<const float> vertex_distances,
                                                       const FaceGroups& groups, double accuracy);

/// check_tolerance() of some evidence of a map.
[[nodiscard]] ToleranceVerdict check_evidence(const Surface& surface, const DistanceMap& map,
                                              const Evidence& evidence, const Tolerance& tolerance);

/// The area of the texels of a group, and its shares.
struct GroupArea {
  ToleranceShares shares;
  double area = 0;  ///< in squared units of the surface
};

/// Returns the area of each group, and how much of it is out of its tolerance. Cost: linear in texels, for
/// all groups together.
[[nodiscard]] std::vector<GroupArea> areas_of_groups(const Surface& surface, const DistanceMap& map,
                                                     const FaceGroups& groups,
                                                     std::span<const Tolerance> tolerances, double accuracy);

}  // namespace sdm::summary
