// The reference engine: the oracle of all others.
#pragma once

#include "engine/engine.h"

namespace sdm::reference {

using engine::ClosestSink;

/// Scalar, double precision, best-first over the binary tree: every number to rounding.
void reference_search(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                      const ClosestSink& deliver);
[[nodiscard]] ClosestPoint reference_closest(const sites::SitesData& sites, const Vec3& point,
                                             double max_distance);

}  // namespace sdm::reference
