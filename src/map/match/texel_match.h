// Stores the points of O2 that belong to texels.
#pragma once

#include <sdm/match.h>

#include <cstddef>

namespace sdm::map {

/// Matches of this surface, all of kind `none`.
[[nodiscard]] inline TexelMatches no_matches(const Surface& surface) {
  const std::size_t texels = surface.texel_faces().size();
  TexelMatches matches;
  matches.resolution = surface.resolution();
  matches.kind.resize(texels, MatchKind::none);
  matches.face.resize(texels, kNone);
  matches.barycentric.resize(texels);
  return matches;
}

inline void store_match(TexelMatches& matches, std::size_t texel, MatchKind kind, const SurfacePoint& point) {
  matches.kind[texel] = kind;
  matches.face[texel] = point.face;
  if (point.face != kNone)
    matches.barycentric[texel] = {static_cast<float>(point.barycentric[1]),
                                  static_cast<float>(point.barycentric[2])};
}

}  // namespace sdm::map
