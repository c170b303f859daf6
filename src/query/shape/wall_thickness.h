// How thick the walls of a solid are.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "query/inside/inside.h"
#include "sites/sites_data.h"

namespace sdm::shape {

/// Bounds on the balls inside a solid that touch its faces, each found on first use. Thread-safe; whether a
/// bound is at most some length does not depend on the order of calls.
class WallThickness {
 public:
  WallThickness(const sites::SitesData& solid, const inside::InsideTest& inside);

  /// Whether all points inside whose closest point of the surface is on this face are at most `most` from
  /// it. May be false also for some faces for which this is so, at the ends of walls and where others meet.
  /// Cost: some searches of the tree for the first call with so large a `most`, constant for others.
  [[nodiscard]] bool is_within(std::uint32_t face, double most) const;

 private:
  [[nodiscard]] double find(std::uint32_t face, double most) const;

  const sites::SitesData* solid_;
  const inside::InsideTest* inside_;
  std::unique_ptr<std::atomic<double>[]> bounds_;  // negative: more than that
};

}  // namespace sdm::shape
