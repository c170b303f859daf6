/// Matches: the point of O2 that belongs to each texel of O1, for what is read there.
///
/// Threads: plain values; the functions may be called concurrently.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <array>
#include <cstdint>
#include <vector>

namespace sdm {

/// How the point of O2 that belongs to a texel was found.
enum class MatchKind : std::uint8_t {
  none,        ///< no face of O1 owns the texel
  closest,     ///< the closest point
  facing,      ///< the closest point of the faces that face as the sample does
  ray,         ///< the nearest hit along the interpolated normal, outwards or inwards, that faces as it does
  too_far,     ///< unmatched: nothing within the largest distance
  facing_away  ///< unmatched: no face faces as the sample does (within the largest distance)
};

/// For each texel of the atlas of O1 (resolution · rows, row 0 at the top): a point of O2.
struct TexelMatches {
  std::uint32_t resolution = 0;
  std::vector<MatchKind> kind;
  std::vector<std::uint32_t> face;                ///< of O2; kNone without a point
  std::vector<std::array<float, 2>> barycentric;  ///< shares of the face's corners 1 and 2
};

/// Returns the points where the vectors of a map end. Throws sdm::Error if the map is not one from the
/// surface to the sites, or there is not enough memory. Cost: linear in texels, all cores.
[[nodiscard]] SDM_API TexelMatches closest_matches(const Surface& surface, const Sites& sites,
                                                   const DistanceMap& map);

}  // namespace sdm
