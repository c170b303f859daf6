// Arguments of the exported functions: numbers and arrays in the memory of the module.
#pragma once

#include <sdm/execution.h>
#include <sdm/mesh.h>

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/host.h"

namespace sdm::js {

inline std::span<const Vec3> points(const double* data, std::uint32_t count) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return {reinterpret_cast<const Vec3*>(data), count};
}

inline Mesh mesh(const double* positions, std::uint32_t vertices, const std::uint32_t* indices,
                 std::uint32_t triangles) {
  const auto at = points(positions, vertices);
  const std::span corners(reinterpret_cast<const Triangle*>(indices), triangles);
  return {{at.begin(), at.end()}, {corners.begin(), corners.end()}, {}};
}

/// A NaN or infinite number of JavaScript stands for an option that is not given.
inline Progress host_progress() {
  return [](std::string_view step, double fraction) {
    return sdm_host_progress(step.data(), static_cast<int>(step.size()), fraction) != 0;
  };
}

}  // namespace sdm::js
