// Scan conversion of characteristic polyhedra in a narrow band (Mauch 2003; Sigg, Peikert & Gross 2003).
#pragma once

#include <span>

#include "research/fields/drawing_task.h"

namespace sdm::fields {

/// Computes the distances within the maximum distance, unsigned, and their sites if `winners` has one entry
/// per point of the grid. Fills the counters and the working memory of the report.
void scan_convert(const DrawingTask& task, Field& field, std::span<std::uint32_t> winners);

}  // namespace sdm::fields
