#include "scenes.h"

#include <sdm/mesh_files.h>

#include <string>

#include "io/mesh/placement.h"
#include "scenes/box_mesh.h"
#include "scenes/reduce_mesh.h"

namespace sdm::bench {

Mesh load(std::string_view name, std::string_view steps) {
  Mesh mesh = read_mesh(std::string(SDM_BENCH_MESHES) + "/" + std::string(name));
  io::place(mesh, io::parse_placement(steps));
  return mesh;
}

Mesh paper_figure() {
  return scenes::reduce_mesh(load("man.off", "fit"), 17200);
}

Mesh paper_box(const Mesh& figure) {
  constexpr double margin = 0.12;
  Box box = bounds(figure);
  for (int k = 0; k < 3; ++k) {
    box.lower[k] -= margin;
    box.upper[k] += margin;
  }
  return scenes::box_mesh(box);
}

std::pair<Mesh, Mesh> figure_to_box() {
  Mesh figure = paper_figure(), box = paper_box(figure);
  return {std::move(figure), std::move(box)};
}

std::pair<Mesh, Mesh> box_to_figure() {
  auto [figure, box] = figure_to_box();
  return {std::move(box), std::move(figure)};
}

}  // namespace sdm::bench
