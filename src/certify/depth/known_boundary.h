// What searches have found of the boundary of a solid.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "certify/depth/boundary_part.h"

namespace sdm::depth {

/// Parts of the boundary, each found for a point of a body. They may bound triangles near that point, too.
class KnownBoundary {
 public:
  void clear() { known_.clear(); }
  void add(const Vec3& from, const BoundaryPart& boundary) { known_.push_back({from, boundary}); }
  [[nodiscard]] std::size_t size() const { return known_.size(); }
  /// The recent ones that were found for the two points nearest to `centre`, other than the faces of
  /// `besides`. None if both are among the first `seen`.
  [[nodiscard]] std::optional<std::array<BoundaryPart, 2>> nearest(const Vec3& centre,
                                                                   std::span<const Near> besides,
                                                                   std::size_t seen) const;

 private:
  struct Known {
    Vec3 from;
    BoundaryPart boundary;
  };
  std::vector<Known> known_;
};

}  // namespace sdm::depth
