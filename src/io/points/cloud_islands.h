// The islands of a cloud, which are left out.
#pragma once

#include <sdm/points.h>

#include <string>

#include "io/points/point_cells.h"

namespace sdm::io {

class CloudIslands {
 public:
  /// Reads the cloud twice. Throws sdm::Error as PointReader does; Cancelled.
  CloudIslands(const std::string& cloud, const PointDistancesOptions& options);

  /// The number of islands, and their reach after the placement; not yet that of their points.
  [[nodiscard]] const PointIslands& found() const { return found_; }
  /// Whether a point of the file, before its placement, is of an island.
  [[nodiscard]] bool has(const Vec3& point) const;

 private:
  PointCells cells_;
  PointIslands found_;
};

}  // namespace sdm::io
