// Closest points of points that are far from each other, one at a time.
#pragma once

#include <sdm/sites.h>

#include <vector>

#include "sites/sites_data.h"
#include "tree/visit.h"

namespace sdm::closest {

/// Per-thread memory, reused between points.
struct SinglePointMemory {
  /// A face whose distance in single precision may be that of the closest one.
  struct Candidate {
    float squared;
    std::uint32_t face;
  };
  std::vector<tree::OpenNode> stack;
  std::vector<Candidate> candidates;
};

/// Whether single precision resolves the point well enough to select faces near it: it is within a few sizes
/// of O2.
[[nodiscard]] bool is_near(const sites::SitesData& sites, const Vec3& query);

/// The closest point of O2, if it is within max_distance: by closest_on_face(), in double precision, of the
/// faces that cannot be told apart in single precision. Requires is_near(query). Cost: a traversal of the
/// tree, nearest first; a group of points (descent.h) costs less for each if they are as close together as
/// the faces.
[[nodiscard]] ClosestPoint closest_to_point(const sites::SitesData& sites, const Vec3& query,
                                            double max_distance, SinglePointMemory& memory);

}  // namespace sdm::closest
