#include "bodies/pairs/unit_maps.h"

#include <algorithm>
#include <limits>

namespace sdm::pairs {
namespace {

// An upper bound on the largest stretch of a map: |A|₂ = √|AAᵀ|₂ ≤ √|AAᵀ|∞, with equality for rotations and
// scales.
double largest_stretch(const Affine& map) {
  double most = 0;
  for (const Vec3& row : map.rows) {
    const Vec3 products{dot(row, map.rows[0]), dot(row, map.rows[1]), dot(row, map.rows[2])};
    most = std::max(most, std::abs(products[0]) + std::abs(products[1]) + std::abs(products[2]));
  }
  return std::sqrt(most);
}

FrameMap in_floats(const Affine& map, double stretch) {
  // Coordinates are at most 1 before the map; a dozen roundings of half a unit in the last place add up.
  constexpr double kError = 16 * std::numeric_limits<float>::epsilon();
  constexpr double kLargest = 1e15;  // the square still fits a float
  FrameMap result{};
  double largest = 1;
  bool usable = true;
  for (int i = 0; i < 3; ++i) {
    double row_sum = std::abs(map.offset[i]);
    for (const double x : map.rows[i]) row_sum += std::abs(x);
    usable = usable && row_sum < kLargest;  // nor NaN
    largest = std::max(largest, row_sum);
  }
  if (!usable) return {{}, {}, 0, std::numeric_limits<float>::infinity()};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.row[i][j] = static_cast<float>(map.rows[i][j]);
    result.offset[i] = static_cast<float>(map.offset[i]);
  }
  result.stretch = static_cast<float>((1 + kError) * stretch);
  result.error = static_cast<float>(kError * largest);
  return result;
}

bool diagonal(const Affine& map) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != j && map.rows[i][j] != 0) return false;
  return true;
}

}  // namespace

UnitMaps::UnitMaps(const MeshPair& pair) {
  constexpr double kBelow = 1 - 1e-6;  // reduced by more than norms are rounded
  const UnitFrame &frame1 = pair.o1.frame, &frame2 = pair.o2.frame;
  Affine to_frame1;
  for (int i = 0; i < 3; ++i) to_frame1.rows[i] = (frame1.scale / frame2.scale) * pair.pose.rows[i];
  to_frame1.offset = frame1.to_unit(pair.pose(frame2.origin));
  const Affine to_frame2 = inverse(to_frame1);
  const double stretch1 = largest_stretch(to_frame1), stretch2 = largest_stretch(to_frame2);
  to[0] = in_floats(to_frame1, stretch1);
  to[1] = in_floats(to_frame2, stretch2);
  aligned = diagonal(to_frame1) && std::isfinite(to[0].error) && std::isfinite(to[1].error);

  const double scale_of_frame1 = std::min(1.0, 1 / stretch1);
  scale_ = scale_of_frame1 * frame1.scale;
  rounding_ = 4e-15 * (1 / scale_ + norm(frame1.origin) + norm(pair.pose(frame2.origin)));
  unit[0] = static_cast<float>(kBelow * scale_of_frame1);
  unit[1] = std::isfinite(to[1].error) ? static_cast<float>(kBelow * scale_of_frame1 / stretch2) : 1;
}

float UnitMaps::round_up(double length) const {
  constexpr double kAbove = 1 + 1e-6;
  return static_cast<float>(std::min(kAbove * scale_ * length, 1e30));
}

Direction UnitMaps::direction(const Vec3& vector) const {
  const Vec3 unit_vector = normalized(vector);
  Direction result{.known = unit_vector != Vec3{}};
  for (int i = 0; i < 3; ++i) {
    const auto x = static_cast<float>(unit_vector[i]);
    result.along[0][i] = -x;
    for (int j = 0; j < 3; ++j) result.along[1][j] += x * to[0].row[i][j];
    result.offset += x * to[0].offset[i];
  }
  return result;
}

}  // namespace sdm::pairs
