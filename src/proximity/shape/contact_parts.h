// The parts of a surface that have one contact each.
#pragma once

#include <cstdint>
#include <vector>

#include "sites/sites_data.h"

namespace sdm::shape {

/// The size of a part relative to that of the mesh: finer details have no contacts of their own.
inline constexpr double kContactPart = 1.0 / 32;

/// For each vertex, the number of its part: a node of the tree, the highest one whose box has at most this
/// diagonal and that has a face of the vertex; kNone for a vertex whose faces are larger, a part by itself.
/// Parts follow the surface as it deforms, so that they identify contacts. Cost: linear.
[[nodiscard]] std::vector<std::uint32_t> contact_parts(const sites::SitesData& sites);

}  // namespace sdm::shape
