// The closest of the faces that a device has found, in double precision.
#pragma once

#include <span>

#include "gpu/face_lists.h"
#include "sites/closest_packet.h"
#include "sites/sites_data.h"

namespace sdm::gpu {

/// Farther than this in the unit frame, single precision does not select faces well.
inline constexpr double kFar = 16;

/// Where the results of points came from.
struct FinishCounts {
  std::size_t nodes = 0, tests = 0, candidates = 0, incomplete = 0, alone = 0;
};

/// The points in the unit frame, for the device. Those that are too far away for single precision are
/// skipped.
void place_points(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                  std::span<QueryPoint> placed);

/// Passes to the sink what exact_closest() has for each point, whichever device has found the lists. Those of
/// the points begin with `first`.
FinishCounts finish(const sites::SitesData& sites, std::span<const Vec3> points,
                    std::span<const QueryPoint> placed, const FaceLists& found, std::size_t first,
                    double max_distance, const sites::ClosestSink& sink);

}  // namespace sdm::gpu
