#include "scenes/level_set.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/parallel.h"

namespace sdm::scenes {
namespace {

class Grid {
 public:
  Grid(const std::function<double(const Vec3&)>& field, const Box& box, double spacing)
      : origin_(box.lower), spacing_(spacing) {
    for (int k = 0; k < 3; ++k)
      size_[k] = static_cast<std::size_t>(std::ceil((box.upper[k] - box.lower[k]) / spacing)) + 1;
    values_.resize(size_[0] * size_[1] * size_[2]);
    parallel_for(values_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) values_[i] = field(point(i));
    });
  }

  Mesh extract_surface() {
    for (std::size_t z = 0; z + 1 < size_[2]; ++z)
      for (std::size_t y = 0; y + 1 < size_[1]; ++y)
        for (std::size_t x = 0; x + 1 < size_[0]; ++x) cut_cube((z * size_[1] + y) * size_[0] + x);
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] Vec3 point(std::size_t i) const {
    const std::array<std::size_t, 3> place{i % size_[0], i / size_[0] % size_[1], i / size_[0] / size_[1]};
    Vec3 p = origin_;
    for (int k = 0; k < 3; ++k) p[k] += spacing_ * static_cast<double>(place[k]);
    return p;
  }

  // Cuts the cube into six tetrahedra around its main diagonal, one for each order of the axes. Adjacent
  // cubes cut their common square along the same diagonal.
  void cut_cube(std::size_t lowest) {
    const std::array<std::size_t, 3> step{1, size_[0], size_[0] * size_[1]};
    std::array<int, 3> order{0, 1, 2};
    do {
      const std::size_t a = lowest, b = a + step[order[0]], c = b + step[order[1]], d = c + step[order[2]];
      const bool right_handed = order[1] == (order[0] + 1) % 3;
      cut(right_handed ? std::array{a, b, c, d} : std::array{a, c, b, d});
    } while (std::ranges::next_permutation(order).found);
  }

  // A tetrahedron abcd, with (b − a) × (c − a) · (d − a) > 0. Its corners are reordered so that those inside
  // come first; each swap reverses the orientation.
  void cut(std::array<std::size_t, 4> t) {
    const auto is_inside = [&](std::size_t i) { return values_[i] < 0; };
    const auto inside = std::ranges::count_if(t, is_inside);
    if (inside == 0 || inside == 4) return;
    bool mirrored = false;
    for (std::size_t first = 0, i = 0; i < 4; ++i) {
      if (!is_inside(t[i])) continue;
      if (i != first) {
        std::swap(t[i], t[first]);
        mirrored = !mirrored;
      }
      ++first;
    }
    if (mirrored) {  // restore the orientation by swapping two corners on the same side
      if (inside == 1)
        std::swap(t[2], t[3]);
      else
        std::swap(t[0], t[1]);
    }
    const auto on = [&](int i, int j) { return vertex_on(t[i], t[j]); };
    if (inside == 1) {
      add({on(0, 1), on(0, 2), on(0, 3)});
    } else if (inside == 3) {
      add({on(0, 3), on(1, 3), on(2, 3)});
    } else {
      add({on(0, 2), on(0, 3), on(1, 3)});
      add({on(0, 2), on(1, 3), on(1, 2)});
    }
  }

  void add(const Triangle& t) { mesh_.triangles.push_back(t); }

  std::uint32_t vertex_on(std::size_t i, std::size_t j) {
    if (i > j) std::swap(i, j);
    const auto [place, is_new] = vertices_.try_emplace(i * values_.size() + j, mesh_.positions.size());
    if (is_new) {
      // The zero of the field, linear along the edge; kept away from the ends, so that no edge of the surface
      // degenerates.
      const double t = std::clamp(values_[i] / (values_[i] - values_[j]), 0.05, 0.95);
      mesh_.positions.push_back(point(i) + t * (point(j) - point(i)));
    }
    return place->second;
  }

  Vec3 origin_;
  double spacing_;
  std::array<std::size_t, 3> size_{};
  std::vector<double> values_;
  std::unordered_map<std::size_t, std::uint32_t> vertices_;  ///< for each cut grid edge
  Mesh mesh_;
};

}  // namespace

Mesh level_set(const std::function<double(const Vec3&)>& field, const Box& box, double spacing) {
  return Grid(field, box, spacing).extract_surface();
}

}  // namespace sdm::scenes
