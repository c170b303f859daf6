// How much an affine map stretches lengths.
#pragma once

#include <sdm/mesh_edit.h>

#include <algorithm>
#include <cmath>

namespace sdm {

/// Returns an upper bound on the factor by which a map stretches lengths; exact for similarities.
[[nodiscard]] inline double largest_stretch(const Transform& map) {
  const auto& rows = map.rows;
  double largest = 0;  // of the sums of absolute values of the rows of AᵀA
  for (int i = 0; i < 3; ++i) {
    double sum = 0;
    for (int j = 0; j < 3; ++j) {
      double product = 0;
      for (int k = 0; k < 3; ++k) product += rows[k][i] * rows[k][j];
      sum += std::abs(product);
    }
    largest = std::max(largest, sum);
  }
  return std::sqrt(largest);
}

}  // namespace sdm
