// The one interface of the engines: closest sites for points that come in an order where neighbours are near
// each other.
#pragma once

#include <sdm/map.h>

#include <span>

#include "mesh/sites_impl.h"

namespace sdm {

/// Finds, for each point, the closest point of O2 within max_distance; type `none` where there is none. One
/// thread; called for batches of points from several threads at once.
using ClosestSearch = void (*)(const Sites::Impl& sites, std::span<const Vec3> points, double max_distance,
                               std::span<ClosestPoint> closest);

/// Scalar, double precision, best-first over the binary tree: every number to rounding.
void reference_search(const Sites::Impl& sites, std::span<const Vec3> points, double max_distance,
                      std::span<ClosestPoint> closest);

/// Groups of points against the wide tree, and lists of its sites, in single precision; the winner in double.
/// Groups are formed of neighbours in `points`. A winner can be another than the closest site only where the two differ by rounding: some 10⁻⁷ of
/// the scene's extent.
void cpu_search(const Sites::Impl& sites, std::span<const Vec3> points, double max_distance,
                std::span<ClosestPoint> closest);

/// The search of an engine.
ClosestSearch search_of(EngineKind engine);

}  // namespace sdm
