// The cpu engine.
#pragma once

#include "engine/engine.h"

namespace sdm::cpu {

using engine::ClosestSink;

/// Groups of points against the wide tree, and lists of its sites, in single precision; the winner in double.
/// Groups are formed of neighbours in `points`. A winner can be another than the closest site only where the
/// two differ by rounding: some 10⁻⁷ of the scene's extent.
void cpu_search(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                const ClosestSink& deliver);

}  // namespace sdm::cpu
