// Grids: checks, and their place in the unit frame of O2.
#pragma once

#include <sdm/volume.h>

#include "geometry/unit_frame.h"

namespace sdm::volume {

/// Throws sdm::Error unless the grid can be used: numbers of points in range, spacings greater than 0 that
/// rounding leaves, coordinates of at most 1e37 in magnitude.
void check_grid(const Grid& grid);

/// The box of the points of the grid.
[[nodiscard]] Box box_of(const Grid& grid);

/// A grid in the unit frame of O2: point (i, j, k) is at origin + (i step[0], j step[1], k step[2]).
struct UnitGrid {
  Vec3 origin{}, step{};
  std::array<std::uint32_t, 3> dims{};

  UnitGrid(const Grid& grid, const UnitFrame& frame)
      : origin(frame.to_unit(grid.origin)), step(frame.scale * grid.spacing), dims(grid.dims) {}
  [[nodiscard]] double at(int axis, double index) const { return origin[axis] + index * step[axis]; }
};

}  // namespace sdm::volume
