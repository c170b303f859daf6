// Distances, positions and normals as the whole numbers of packed arrays.
#pragma once

#include <sdm/types.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

namespace sdm::io {

/// The bits of a float as a number whose order is that of the floats; one number for all that is not finite.
[[nodiscard]] inline std::uint32_t ordered(float value) {
  if (!std::isfinite(value)) return 0xFFFFFFFFu;
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return bits ^ (bits >> 31 ? 0xFFFFFFFFu : 0x80000000u);
}

/// Positions in a box as steps from its corner, 2^bits along its longest side.
struct Steps {
  Vec3 origin{};
  double length = 1;

  explicit Steps(const Box& box, int bits = 21) : origin(box.lower) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, box.upper[k] - box.lower[k]);
    if (longest > 0 && std::isfinite(longest)) length = std::ldexp(longest, -bits);
  }
  [[nodiscard]] std::uint32_t operator()(const Vec3& p, int k) const {
    return static_cast<std::uint32_t>(std::max(0.0, (p[k] - origin[k]) / length + 0.5));
  }
  [[nodiscard]] nlohmann::ordered_json json() const { return {{"origin", origin}, {"step", length}}; }
};

/// A direction as a point of an octahedron folded to a square, 8 bits a coordinate.
[[nodiscard]] inline std::uint32_t octahedral(const Vec3f& n) {
  const float sum = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
  float x = n[0] / sum, y = n[1] / sum;
  if (n[2] < 0) {
    const float folded = (1 - std::abs(y)) * (x < 0 ? -1.f : 1.f);
    y = (1 - std::abs(x)) * (y < 0 ? -1.f : 1.f);
    x = folded;
  }
  const auto byte = [](float c) {
    return static_cast<std::uint32_t>(std::clamp(127.5f * c + 128, 0.f, 255.f));
  };
  return byte(x) | byte(y) << 8;
}

/// How many vertices the vertex of each corner was before the first one that has not occurred yet: 0 for
/// that one. Vertices must be numbered in the order of their first use.
[[nodiscard]] inline std::vector<std::uint32_t> corner_codes(std::span<const Triangle> triangles) {
  std::vector<std::uint32_t> codes;
  std::uint32_t next = 0;
  for (const Triangle& triangle : triangles)
    for (const std::uint32_t vertex : triangle) {
      codes.push_back(next - vertex);
      if (vertex == next) ++next;
    }
  return codes;
}

/// Whether a face does not repeat a corner.
[[nodiscard]] inline bool is_visible(const Triangle& t) {
  return t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
}

}  // namespace sdm::io
