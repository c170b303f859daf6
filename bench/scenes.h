// The meshes that the benchmarks measure.
#pragma once

#include <sdm/mesh.h>

#include <string_view>

namespace sdm::bench {

/// A mesh of the benchmarks by its file name, placed by the steps of parse_transform.
[[nodiscard]] Mesh load(std::string_view name, std::string_view steps = "");

/// The figure of the paper's Figure 1: a standing man, 1 high, z up; CGAL's man.off reduced to 17,200
/// triangles.
[[nodiscard]] Mesh paper_figure();

/// The 12 triangles around a mesh, `margin` beyond its bounds, seen from outside counter-clockwise.
[[nodiscard]] Mesh box_around(const Mesh& mesh, double margin);

}  // namespace sdm::bench
