// The places of a cloud where it deviates most.
#pragma once

#include <sdm/points.h>

#include <span>

#include "io/points/measured_rows.h"
#include "io/points/point_cells.h"
#include "map/places/place_limits.h"

namespace sdm::io {

/// Clusters of points beyond the same limit. A place is small with less than 1e-5 of the points, or less than
/// four.
class CloudPlaces {
 public:
  /// `found`: with its extremes, percentiles and accuracy; must outlive this. `group_is_out`: the distances
  /// of a group are out of its tolerance.
  CloudPlaces(const PointDistances& found, const PointDistancesOptions& options, bool group_is_out,
              const Box& usual);

  /// Each point that counts, by its number in the file.
  void add(const MeasuredPoint& point, std::uint64_t number);
  /// `names`: of the faces of O2.
  [[nodiscard]] bool by_tolerance() const { return limits_.by_tolerance(); }
  [[nodiscard]] Places places(std::span<const FaceNames> names) const;

 private:
  const PointDistances& found_;
  map::PlaceLimits limits_;
  PointCells cells_;
};

}  // namespace sdm::io
