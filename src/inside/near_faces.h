// Faces so near to another one that the two might intersect.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/triangle.h"
#include "sites/sites_data.h"

namespace sdm::inside {

/// A length in the unit frame: more than twice the error with which engines find closest sites.
inline constexpr double kClearance = 4e-6;
/// Faces that share a corner or an edge at a smaller dihedral angle, in radians, count as near.
inline constexpr double kClearAngle = 1e-3;

/// The corners of a face in the unit frame.
[[nodiscard]] Corners unit_corners(const sites::SitesData& sites, std::uint32_t face);

/// Whether a separating axis was found along which the triangles are farther apart than kClearance:
/// sufficient, not necessary.
[[nodiscard]] bool apart(const Corners& a, const Corners& b);

/// Sets `near` to the faces that may be nearer to `face` than kClearance, apart from the corners and edges
/// that they share, or at an angle smaller than kClearAngle there. A face without any is embedded: no other
/// face intersects it. Cost: O(log n), plus linear in the faces whose boxes are near.
void find_near_faces(const sites::SitesData& sites, std::uint32_t face, std::vector<std::uint32_t>& near);
/// Sets flags[f] to whether find_near_faces(f) finds a face, for each face f of a closed, orientable mesh, up
/// to rounding and except at angles near kClearAngle. Compares each pair once, and searches the tree once for
/// the faces of a leaf, at a fraction of the cost of a search for each face; all cores.
void flag_faces_with_near(const sites::SitesData& sites, std::vector<std::uint8_t>& flags);

}  // namespace sdm::inside
