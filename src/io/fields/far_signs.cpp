#include "io/fields/far_signs.h"

#include <algorithm>
#include <cmath>

namespace sdm::io {

bool has_far_signs(const DistanceField& field) {
  double largest = 0;
  for (int k = 0; k < 3; ++k)
    if (field.grid.dims[k] > 1) largest = std::max(largest, field.grid.spacing[k]);
  return field.sign.method == SignMethod::exact && field.max_distance >= largest;
}

std::vector<bool> far_signs(const DistanceField& field) {
  const auto& [nx, ny, nz] = field.grid.dims;
  const std::vector<float>& d = field.distance;
  std::vector<bool> inside(d.size());
  // The first points of the grid that have no value are connected, and with the first one that has one.
  const auto known = std::ranges::find_if(d, [](float x) { return !std::isnan(x); });
  bool first_of_slice = known != d.end() && *known < 0;
  const auto at = [&](std::size_t i, bool neighbour) { return std::isnan(d[i]) ? neighbour : d[i] < 0; };
  std::size_t i = 0;
  for (std::uint32_t z = 0; z < nz; ++z) {
    first_of_slice = at(i, first_of_slice);
    bool first_of_row = first_of_slice;
    for (std::uint32_t y = 0; y < ny; ++y) {
      first_of_row = at(i, first_of_row);
      bool here = first_of_row;
      for (std::uint32_t x = 0; x < nx; ++x, ++i) inside[i] = here = at(i, here);
    }
  }
  return inside;
}

}  // namespace sdm::io
