// Which polygons of one file are those of another.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sdm::io {

/// Polygons as cycles of vertex numbers; kNone for a vertex that equals no other.
struct PolygonCycles {
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> ends;  ///< for each polygon, one past its last corner

  [[nodiscard]] std::size_t size() const { return ends.size(); }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t polygon) const {
    const std::uint32_t begin = polygon == 0 ? 0 : ends[polygon - 1];
    return {corners.data() + begin, ends[polygon] - begin};
  }
};

/// The polygon of the earlier file that a polygon is.
struct PolygonMatch {
  std::uint32_t polygon = kNone;  ///< none
  std::uint32_t shift = 0;        ///< its corner i is corner (i + shift) mod n of the later polygon
};

/// Matches polygons with the same cycle of numbers, from whichever corner it starts: those at the same place
/// in both lists first, then the others, equal ones in the order of the lists. Adds to `matches`, one for
/// each polygon of `now`, whose present entries stay; each polygon of `before` is matched once at most. Cost:
/// linear for polygons at the same place, O(n log n) for the others.
void match_polygons(const PolygonCycles& before, const PolygonCycles& now,
                    std::vector<PolygonMatch>& matches);

}  // namespace sdm::io
