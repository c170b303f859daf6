// Matches along the normals of O1.
#pragma once

#include <sdm/match.h>

namespace sdm::map {

/// match_texels() of MatchMethod::ray, with options in range.
[[nodiscard]] TexelMatches ray_matches(const Surface& surface, const Sites& sites,
                                       const MatchOptions& options);

}  // namespace sdm::map
