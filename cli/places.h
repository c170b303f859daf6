// Where a surface or a cloud is out of tolerance, as text.
#pragma once

#include <sdm/summary.h>

#include <string>

/// Lines on the largest places out of the tolerance, in the column of other results; empty if nothing is out
/// of it. `size`: of what is measured, for coordinates.
[[nodiscard]] std::string place_lines(const sdm::Summary& summary, double size);
