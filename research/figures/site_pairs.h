// The pairs of a site and a face for which Algorithm 1 draws a polygon.
#pragma once

#include <sdm/sites.h>
#include <sdm/surface.h>

#include <cstdint>
#include <vector>

namespace sdm::figures {

/// Indices of faces of O1, in the order in which Algorithm 1 draws on them, site by site; neighbouring sites
/// follow each other.
using DrawOrder = std::vector<std::uint32_t>;

/// All pairs of Lemma 1: a site's region of influence intersects the face. Only faces that own a texel are
/// counted. Cost: the product of both numbers.
[[nodiscard]] DrawOrder intersecting_pairs(const Surface& surface, const Sites& sites);

/// Those of them that no culling can avoid: the site is the closest at some texel of the face.
[[nodiscard]] DrawOrder winning_pairs(const Surface& surface, const Sites& sites);

}  // namespace sdm::figures
