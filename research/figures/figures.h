// The figures and tables, one source file each.
#pragma once

#include "research/figures/figure.h"
#include "research/figures/run.h"

namespace sdm::figures {

/// A figure in a box: distance, Voronoi diagram, direction.
[[nodiscard]] Figure figure1(Run& run);
/// The affine map of a triangle, and Lemma 1.
[[nodiscard]] Figure figure2(Run& run);
/// Two letters: maps and proximity queries.
[[nodiscard]] Figure figure3(Run& run);
/// The affine map of a triangle that deforms.
[[nodiscard]] Figure figure4(Run& run);
/// The spacing of samples under scale and shear.
[[nodiscard]] Figure figure5(Run& run);
/// The relative error over a deforming sequence.
[[nodiscard]] Figure figure6(Run& run);
/// Two bunnies: maps and proximity queries.
[[nodiscard]] Figure figure7(Run& run);
/// Time per frame, of maps and of volumes.
[[nodiscard]] Figure figure8(Run& run);
/// Section 6.1: time against the number of polygons.
[[nodiscard]] Figure polygon_count(Run& run);
/// Section 6.3: time, memory and error against resolution.
[[nodiscard]] Figure table_complexity(Run& run);
/// Section 4.2: what culling saves.
[[nodiscard]] Figure culling(Run& run);
/// Section 4.1: hits of the stencil cache.
[[nodiscard]] Figure stencil(Run& run);
/// Algorithm 1 as printed, and what each correction contributes.
[[nodiscard]] Figure literal_algorithm(Run& run);

}  // namespace sdm::figures
