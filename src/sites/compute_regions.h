// Computes regions of influence, many sites at a time.
#pragma once

#include <cstddef>

#include "sites/regions.h"

namespace sdm::sites {

// Each function selects the best available vector instructions at run time.

/// The faces of the leaves from `begin` to `end`: their regions and shapes, and the discs of their bounds.
void compute_faces(Regions& regions, const Placement& placement, std::span<FaceShape> shapes,
                   std::size_t begin, std::size_t end);

/// The regions of the edges from `begin` to `end`.
void compute_edges(Regions& regions, const Placement& placement, std::size_t begin, std::size_t end);

/// The regions of the vertices from `begin` to `end`.
void compute_vertices(Regions& regions, const Placement& placement, std::size_t begin, std::size_t end);

}  // namespace sdm::sites
