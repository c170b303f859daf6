#include "io/page/report/largest_by_cell.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "geometry/vec.h"

namespace sdm::io {

LargestByCell::LargestByCell(const Box& box)
    : lo_(box.lower), width_(kWidth * diagonal(box)), places_(kSide * kSide * kSide) {}

void LargestByCell::add(const CellPlace& place) {
  if (!std::isfinite(place.distance)) return;
  CellPlace& largest = places_[cell(place.point)];
  // The first one of equals stays.
  if (largest.distance == 0 || std::abs(place.distance) > std::abs(largest.distance)) largest = place;
}

std::vector<CellPlace> LargestByCell::largest() const {
  std::vector<CellPlace> result;
  std::ranges::copy_if(places_, std::back_inserter(result),
                       [](const CellPlace& p) { return p.distance != 0; });
  std::ranges::stable_sort(result, std::greater(), [](const CellPlace& p) { return std::abs(p.distance); });
  return result;
}

std::size_t LargestByCell::cell(const Vec3& p) const {
  std::size_t index = 0;
  for (int k = 0; k < 3; ++k) {
    const double at = width_ > 0 ? (p[k] - lo_[k]) / width_ : 0;
    index = index * kSide + static_cast<std::size_t>(std::clamp(at, 0.0, kSide - 1.0));
  }
  return index;
}

}  // namespace sdm::io
