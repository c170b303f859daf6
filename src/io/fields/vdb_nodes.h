// The tree of an OpenVDB grid over a dense field: a root with upper nodes of 32³ lower nodes of 16³ leaves of
// 8³ points.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace sdm::io {

using Index3 = std::array<std::uint32_t, 3>;

/// Bits of the children of a node with 2^kLog2 children along each axis, in the order of the file: z fastest.
template <int kLog2>
struct NodeMask {
  static constexpr std::uint32_t kSide = 1u << kLog2, kSize = kSide * kSide * kSide;
  std::array<std::uint64_t, kSize / 64> words{};
  std::uint32_t count = 0;

  [[nodiscard]] static Index3 place(std::uint32_t i) {
    return {i >> (2 * kLog2), i >> kLog2 & (kSide - 1), i & (kSide - 1)};
  }
  void set(std::uint32_t i) {
    words[i / 64] |= std::uint64_t{1} << (i % 64);
    ++count;
  }
  [[nodiscard]] bool operator[](std::uint32_t i) const { return (words[i / 64] >> (i % 64) & 1) != 0; }
};

/// Whether blocks of a power of two of points along each axis contain points with values.
class BlockTable {
 public:
  BlockTable(const Index3& points, std::uint32_t side) {
    for (int k = 0; k < 3; ++k) dims_[k] = (points[k] + side - 1) / side;
    used_.resize(std::size_t{dims_[0]} * dims_[1] * dims_[2]);
  }
  [[nodiscard]] const Index3& dims() const { return dims_; }
  [[nodiscard]] bool inside(const Index3& b) const {
    return b[0] < dims_[0] && b[1] < dims_[1] && b[2] < dims_[2];
  }
  void set(const Index3& b) { used_[index(b)] = 1; }
  /// False outside of the grid.
  [[nodiscard]] bool used(const Index3& b) const { return inside(b) && used_[index(b)] != 0; }

 private:
  [[nodiscard]] std::size_t index(const Index3& b) const {
    return b[0] + std::size_t{dims_[0]} * (b[1] + std::size_t{dims_[1]} * b[2]);
  }
  Index3 dims_{};
  std::vector<std::uint8_t> used_;
};

[[nodiscard]] constexpr Index3 operator*(std::uint32_t s, const Index3& b) {
  return {s * b[0], s * b[1], s * b[2]};
}
[[nodiscard]] constexpr Index3 operator+(const Index3& a, const Index3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

}  // namespace sdm::io
