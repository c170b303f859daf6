// Charts on the grid on which overlap is decided.
#pragma once

#include <sdm/mesh.h>

#include <vector>

#include "atlas/charts/chart.h"
#include "atlas/charts/overlap.h"

namespace sdm::atlas {

/// The faces in the chart's projection on a grid across it, right and up seen from outside:
/// counter-clockwise, except where snapping flips them.
[[nodiscard]] std::vector<GridTriangle> snap(const Mesh& mesh, const Chart& chart);

}  // namespace sdm::atlas
