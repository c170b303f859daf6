// Brute force, DiFi and linear factorization: slice by slice, every site that may influence it.
#pragma once

#include <span>

#include "research/fields/drawing_task.h"

namespace sdm::fields {

/// Computes the distances of the field by the method of the task, unsigned, and their sites if `winners` has
/// one entry per point of the grid. Fills the counters and the working memory of the report.
void sweep_slices(const DrawingTask& task, Field& field, std::span<std::uint32_t> winners);

}  // namespace sdm::fields
