#include "volume/grid.h"

#include <sdm/error.h>

#include <cmath>
#include <string>

namespace sdm {
namespace {

constexpr double kMostCoordinate = 1e37;  // as for meshes

std::string axis_name(int k) {
  return std::string(1, static_cast<char>('x' + k));
}

void check_dims(const std::array<std::uint32_t, 3>& dims) {
  for (int k = 0; k < 3; ++k)
    if (dims[k] < 1 || dims[k] > Grid::kMostPoints)
      throw Error("a grid needs 1 to " + std::to_string(Grid::kMostPoints) + " points along each axis, not " +
                  std::to_string(dims[k]) + " along " + axis_name(k));
}

void check_box(const Box& box) {
  for (int k = 0; k < 3; ++k)
    if (!(box.lower[k] <= box.upper[k]) || !(std::abs(box.lower[k]) <= kMostCoordinate) ||
        !(std::abs(box.upper[k]) <= kMostCoordinate))
      throw Error("the bounds of a grid must be a box, from low to high, with coordinates of at most 1e37");
}

}  // namespace

void volume::check_grid(const Grid& grid) {
  check_dims(grid.dims);
  for (int k = 0; k < 3; ++k) {
    if (!(grid.spacing[k] > 0)) throw Error("the spacing of a grid must be greater than 0");
    const double last = grid.origin[k] + (grid.dims[k] - 1) * grid.spacing[k];
    if (!(std::abs(grid.origin[k]) <= kMostCoordinate && std::abs(last) <= kMostCoordinate &&
          grid.spacing[k] <= kMostCoordinate))
      throw Error("a grid has a coordinate that is NaN or beyond 1e37");
    const double most = std::max(std::abs(grid.origin[k]), std::abs(last));
    if (grid.dims[k] > 1 && !(most + 0.5 * grid.spacing[k] > most))
      throw Error("the points of a grid cannot be told apart along " + axis_name(k) +
                  "; choose a larger spacing or fewer points");
  }
}

Box volume::box_of(const Grid& grid) {
  return {grid.origin, grid.point(grid.dims[0] - 1, grid.dims[1] - 1, grid.dims[2] - 1)};
}

Grid make_grid(const Box& bounds, const std::array<std::uint32_t, 3>& dims) {
  check_dims(dims);
  check_box(bounds);
  Grid grid{.origin = bounds.lower, .spacing = {1, 1, 1}, .dims = dims};
  for (int k = 0; k < 3; ++k) {
    const double length = bounds.upper[k] - bounds.lower[k];
    if (dims[k] == 1) {
      grid.origin[k] = bounds.lower[k] + 0.5 * length;
      grid.spacing[k] = length > 0 ? length : 1;
    } else if (length > 0) {
      grid.spacing[k] = length / (dims[k] - 1);
    } else {
      throw Error("the bounds of a grid have no extent along " + axis_name(k) +
                  "; give larger bounds or one point along it");
    }
  }
  volume::check_grid(grid);
  return grid;
}

Grid make_grid(const Box& bounds, double spacing) {
  check_box(bounds);
  if (!(spacing > 0)) throw Error("the spacing of a grid must be greater than 0");
  Grid grid{.origin = {}, .spacing = {spacing, spacing, spacing}, .dims = {}};
  for (int k = 0; k < 3; ++k) {
    // Rounding adds no cell.
    const double cells = std::ceil((1 - 1e-12) * (bounds.upper[k] - bounds.lower[k]) / spacing);
    if (!(cells < Grid::kMostPoints))
      throw Error("a grid with this spacing has more than " + std::to_string(Grid::kMostPoints) +
                  " points along " + axis_name(k) + "; choose a larger spacing");
    grid.dims[k] = static_cast<std::uint32_t>(cells) + 1;
    grid.origin[k] = 0.5 * (bounds.lower[k] + bounds.upper[k] - cells * spacing);
  }
  volume::check_grid(grid);
  return grid;
}

}  // namespace sdm
