// Unions of boxes.
#pragma once

#include <sdm/mesh.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

namespace sdm::scenes {

using Blocks = std::vector<Box>;

/// The boundary of the union, on the grid of all sides.
class UnionMesh {
 public:
  explicit UnionMesh(const Blocks& blocks) : blocks_(blocks) {
    for (int k = 0; k < 3; ++k) {
      for (const Box& b : blocks) at_[k].insert(at_[k].end(), {b.lower[k], b.upper[k]});
      std::ranges::sort(at_[k]);
      at_[k].erase(std::unique(at_[k].begin(), at_[k].end()), at_[k].end());
    }
  }
  [[nodiscard]] Mesh mesh() {
    Cell cell;
    for (cell[0] = 0; cell[0] + 1 < count(0); ++cell[0])
      for (cell[1] = 0; cell[1] + 1 < count(1); ++cell[1])
        for (cell[2] = 0; cell[2] + 1 < count(2); ++cell[2])
          if (is_filled(cell))
            for (const int k : {0, 1, 2})
              for (const int up : {0, 1}) add_side(cell, k, up);
    return mesh_;
  }

 private:
  using Cell = std::array<int, 3>;

  [[nodiscard]] int count(int k) const { return static_cast<int>(at_[k].size()); }
  [[nodiscard]] bool is_filled(const Cell& cell) const {
    Vec3 middle;
    for (int k = 0; k < 3; ++k) {
      if (cell[k] < 0 || cell[k] + 1 >= count(k)) return false;
      middle[k] = 0.5 * (at_[k][cell[k]] + at_[k][cell[k] + 1]);
    }
    return std::ranges::any_of(blocks_, [&](const Box& b) {
      for (int k = 0; k < 3; ++k)
        if (middle[k] < b.lower[k] || middle[k] > b.upper[k]) return false;
      return true;
    });
  }
  void add_side(const Cell& cell, int k, int up) {
    Cell beyond = cell;
    beyond[k] += up == 1 ? 1 : -1;
    if (is_filled(beyond)) return;
    const auto corner = [&](int i, int j) {
      Cell c = cell;
      c[k] += up;
      c[(k + 1) % 3] += i;
      c[(k + 2) % 3] += j;
      const auto [place, added] = numbers_.try_emplace(c, static_cast<std::uint32_t>(mesh_.positions.size()));
      if (added) mesh_.positions.push_back({at_[0][c[0]], at_[1][c[1]], at_[2][c[2]]});
      return place->second;
    };
    const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
    mesh_.triangles.push_back(up == 1 ? Triangle{a, b, c} : Triangle{a, c, b});
    mesh_.triangles.push_back(up == 1 ? Triangle{a, c, d} : Triangle{a, d, c});
  }

  const Blocks& blocks_;
  std::array<std::vector<double>, 3> at_;
  std::map<Cell, std::uint32_t> numbers_;
  Mesh mesh_;
};

[[nodiscard]] inline Mesh union_of(const Blocks& blocks) {
  return UnionMesh(blocks).mesh();
}

/// A plate of this half side, centred on the z axis above z = 0, with a square hole through it.
[[nodiscard]] inline Mesh plate_with_hole(double half_side, double half_hole, double height) {
  const double a = half_side, b = half_hole;
  return union_of({{{-a, -a, 0}, {a, -b, height}},
                   {{-a, b, 0}, {a, a, height}},
                   {{-a, -b, 0}, {-b, b, height}},
                   {{b, -b, 0}, {a, b, height}}});
}

}  // namespace sdm::scenes
