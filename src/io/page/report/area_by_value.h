// How the area of a surface, or the points of a cloud, are distributed over the distances.
#pragma once

#include <sdm/map.h>
#include <sdm/surface.h>

#include <cstdint>
#include <vector>

namespace sdm::io {

/// The area of the texels, as fractions of that of all, those without a value included, in two sets of bins:
/// those of floats that agree in their upper 16 bits (1/128 of their size wide), which are fine near 0, and
/// bins of equal width, which are fine anywhere else. The area between two edges of bins is exact but for
/// rounding.
struct AreaByValue {
  std::vector<std::uint32_t> keys;  ///< of the bins that are not empty, ascending: see below
  std::vector<float> area_of_key;   ///< fraction of the area
  double lower = 0, upper = 0;      ///< the least and the largest distance
  std::vector<float> area;          ///< the same of kBins bins of equal width from lo to hi
  double without_value = 0;         ///< fraction of the area

  static constexpr std::size_t kBins = 2048;
};

/// Adds up areas by distance. The key of a float: the upper 16 bits of a number in the order of the floats,
/// which is that of their bits, inverted if the sign is set, otherwise with the sign set.
class AreaSums {
 public:
  /// `lo` and `hi`: the least and the largest distance that will be added.
  AreaSums(double lo, double hi);
  void add(float distance, double area);
  void add_without_value(double area) { without_value_ += area; }
  void add(const AreaSums& other);
  [[nodiscard]] AreaByValue fractions() const;

 private:
  double lo_, hi_, bins_per_unit_, without_value_ = 0;
  std::vector<double> by_key_, by_bin_;
};

/// The area of the texels of a map by their distance. Cost: linear, all cores.
[[nodiscard]] AreaByValue area_by_value(const Surface& surface, const DistanceMap& map);

}  // namespace sdm::io
