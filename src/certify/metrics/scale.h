// Lengths that the measures of two meshes depend on.
#pragma once

#include <limits>

namespace sdm::metrics {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Lengths of both meshes together.
struct Scale {
  double size = 0;      ///< the diagonal of their box
  double rounding = 0;  ///< of distances and coordinates, in double precision
  double accuracy = 0;  ///< of the cpu engine
};

}  // namespace sdm::metrics
