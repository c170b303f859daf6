// Meshes and grids on which all methods are compared.
#pragma once

#include <sdm/volume.h>

#include <random>
#include <string>
#include <vector>

#include "geometry/vec.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {

struct FieldScene {
  std::string name;
  Mesh mesh;
  Grid grid;
};

inline Box around(const Mesh& mesh, double margin) {
  Box box = bounds(mesh);
  const double by = margin * diagonal(box);
  for (int k = 0; k < 3; ++k) {
    box.lower[k] -= by;
    box.upper[k] += by;
  }
  return box;
}

inline Box in_the_middle(const Mesh& mesh, double part) {
  const Box box = bounds(mesh);
  Box result{centre(box), centre(box)};
  for (int k = 0; k < 3; ++k) {
    result.lower[k] -= part * diagonal(box);
    result.upper[k] += part * diagonal(box);
  }
  return result;
}

/// Closed, open, non-manifold and degenerate meshes; grids around them, through them and beside them.
inline std::vector<FieldScene> field_scenes() {
  std::mt19937 random(5);
  const Mesh cow = load("cow.off"), holes = load("elephant-with-holes.off"), eight = load("eight.off");
  std::vector<FieldScene> scenes;
  const auto add = [&](std::string name, Mesh mesh, const Grid& grid) {
    scenes.push_back({std::move(name), std::move(mesh), grid});
  };
  add("closed", eight, make_grid(around(eight, 0.2), {37, 21, 30}));
  add("closed_fine", cow, make_grid(around(cow, 0.1), {13, 10, 11}));
  add("open", holes, make_grid(around(holes, 0.1), {12, 11, 13}));
  add("height_field", height_field(9), make_grid(around(height_field(9), 0.5), {17, 18, 19}));
  add("moebius", band(12, true), make_grid(around(band(12, true), 0.3), {23, 24, 25}));
  const Mesh defects = with_defects(sphere(3));
  add("defects", defects, make_grid(around(defects, 0.3), {25, 26, 27}));
  add("soup", soup(150, random), make_grid({{-0.5, -0.5, -0.5}, {1.5, 1.5, 1.5}}, {22, 23, 24}));
  const Mesh degenerate = degenerate_soup(80, 7);
  add("degenerate", degenerate, make_grid(around(degenerate, 0.2), {21, 22, 23}));
  add("needles", needles(1e-4), make_grid(around(needles(1e-4), 0.2), {24, 23, 22}));
  const Mesh crossing = joined(sphere(3), moved(ring(20), {0.9, 0.2, 0.1}));
  add("self_intersecting", crossing, make_grid(around(crossing, 0.1), {31, 24, 20}));
  // Grid points on vertices, edges and faces: distances of 0, ties everywhere.
  add("cube_on_grid", cube(), make_grid({{-2, -2, -2}, {2, 2, 2}}, {17, 17, 17}));
  // The grid cuts through the mesh, and is far from most of its sites.
  add("inside_mesh", eight, make_grid(in_the_middle(eight, 0.1), {16, 17, 18}));
  Box beside = bounds(eight);
  for (int k = 0; k < 3; ++k) {
    beside.lower[k] += 2;
    beside.upper[k] += 3;
  }
  add("beside_mesh", eight, make_grid(beside, {12, 13, 14}));
  add("far_away", ring(16), make_grid({{1e3, 2e3, 0}, {3e3, 3e3, 1e3}}, {9, 8, 7}));
  // Points apart along one axis only, or none.
  add("slice", eight, make_grid(around(eight, 0.1), {40, 41, 1}));
  add("row", eight, make_grid(around(eight, 0.1), {1, 64, 1}));
  add("point", eight, make_grid(around(eight, 0.1), {1, 1, 1}));
  add("flat_cells", eight, make_grid(around(eight, 0.1), {5, 60, 12}));
  const Mesh moved_away = moved(eight, {1e5, -2e5, 3e5});
  add("large_coordinates", moved_away, make_grid(around(moved_away, 0.1), {20, 18, 16}));
  return scenes;
}

inline double diagonal_of(const FieldScene& scene) {
  Box box = bounds(scene.mesh);
  extend(box, scene.grid.origin);
  extend(box, scene.grid.point(scene.grid.dims[0] - 1, scene.grid.dims[1] - 1, scene.grid.dims[2] - 1));
  return diagonal(box);
}

/// Some of the points of a grid, with their indices.
template <class Visit>
void for_some_points(const Grid& grid, std::size_t most, Visit&& visit) {
  const std::size_t step = 1 + grid.size() / most;
  for (std::size_t i = 0; i < grid.size(); i += step) {
    const auto x = static_cast<std::uint32_t>(i % grid.dims[0]);
    const auto y = static_cast<std::uint32_t>(i / grid.dims[0] % grid.dims[1]);
    const auto z = static_cast<std::uint32_t>(i / grid.dims[0] / grid.dims[1]);
    visit(i, grid.point(x, y, z));
  }
}

}  // namespace sdm::test
