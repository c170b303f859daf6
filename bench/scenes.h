// The meshes that the benchmarks measure.
#pragma once

#include <sdm/mesh.h>

#include <string_view>

namespace sdm::bench {

/// A mesh of the benchmarks by its file name, placed by the steps of scenes::parse_placement.
[[nodiscard]] Mesh load(std::string_view name, std::string_view steps = "");

/// The figure of the paper's Figure 1: a standing man, 1 high, z up; CGAL's man.off reduced to 17,200
/// triangles.
[[nodiscard]] Mesh paper_figure();

/// The box of Figure 1: 12 triangles, 0.12 beyond the figure's bounds.
[[nodiscard]] Mesh paper_box(const Mesh& figure);

}  // namespace sdm::bench
