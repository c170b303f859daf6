// A deep point of a part of an edge.
#pragma once

#include "bodies/contacts/surface_point.h"

namespace sdm::contacts {

/// A straight line in a solid, in its frame, and how deep its ends are at most.
struct EdgeInside {
  Vec3 from{}, to{};
  double from_depth = 0, to_depth = 0;
};

/// A bound on its depths, which are 1-Lipschitz: half of the sum of those of its ends and its length.
[[nodiscard]] double most_between(const EdgeInside& line);

/// A point of the line that is deeper than `enough`, near the deepest one; its distance is at least −enough
/// if none was found. Depths are 1-Lipschitz, so that between two points s apart none exceeds half of the sum
/// of their depths and s: the point where that bound is attained is measured next, where the bound is
/// largest. `near_face`: close to the line, or kNone. Cost: of up to eight closest points.
[[nodiscard]] SurfacePoint deep_point(const shape::Body& solid, const EdgeInside& line, double enough,
                                      std::uint32_t near_face);

}  // namespace sdm::contacts
