// Signs and sites of a field whose closest sites are known.
#pragma once

#include <span>

#include "research/fields/drawing_task.h"

namespace sdm::fields {

/// `winners`: the closest site of each point of the grid (site_code), kNone where there is none. Negates the
/// distances inside O2, if the task is signed, and stores the sites, if they were asked for. The sign is
/// decided at the closest point in double precision, found from the site.
void store_sites(const DrawingTask& task, std::span<const std::uint32_t> winners, DistanceField& field);

}  // namespace sdm::fields
