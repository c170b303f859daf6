// Fewer triangles by collapses of edges.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "simplify/wedges.h"

namespace sdm::simplify {

/// Triangles that are left, and meshoptimizer's estimate of their error, as a length.
struct Collapsed {
  std::vector<Triangle> triangles;
  double estimate = 0;
};

/// Where collapses end: at a count, or before an error, an estimate too.
struct CollapseLimit {
  std::size_t triangles = 0;
  double error = 0;
};

/// Collapses edges of some triangles of the wedges. Two faces with the same corners that turn their backs on
/// each other, which collapses leave where a part is thin, go with them unless the wedges have them: their
/// neighbours share the edges then. Of faces that get wrong in the texture, edges are flipped; where that
/// does not help, the vertices around them stay, or less is collapsed. The result may be the triangles as
/// they are.
[[nodiscard]] Collapsed collapse(const Wedges& wedges, std::span<const Triangle> triangles,
                                 const CollapseLimit& limit);

}  // namespace sdm::simplify
