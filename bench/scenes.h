// The benchmarks' meshes.
#pragma once

#include <sdm/mesh.h>

#include <string_view>
#include <utility>

namespace sdm::bench {

/// Reads a mesh by its file name, and applies the steps of io::parse_placement.
[[nodiscard]] Mesh load(std::string_view name, std::string_view steps = "");

/// A figure as in the paper's Figure 1: a standing man, 1 high, with the z axis up; CGAL's man.off reduced to
/// 17,200 triangles.
[[nodiscard]] Mesh paper_figure();

/// A box around it as there: 12 triangles, 0.12 larger than the figure's bounds on each side.
[[nodiscard]] Mesh paper_box(const Mesh& figure);

/// O1 and O2 of the maps between the two.
[[nodiscard]] std::pair<Mesh, Mesh> figure_to_box();
[[nodiscard]] std::pair<Mesh, Mesh> box_to_figure();

}  // namespace sdm::bench
