// Whether the numbers of sites that were read from a file are such as sites have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sites/sites_data.h"

namespace sdm::sites {

/// Coordinates and lengths in the unit frame are less than this: its cube has sides of 2.
inline constexpr float kUnitReach = 8;

/// Whether boxes of the trees contain those of their children and the faces of their leaves, points are those
/// of the mesh, and all other numbers are finite and no larger than those of any sites. Regions and normals
/// may still be wrong: then searches may find other sites than the closest ones, or none. All else must be
/// valid (see match()). Cost: linear, all cores.
[[nodiscard]] bool have_valid_numbers(const SitesData& sites);

/// Whether no number is larger in magnitude than the limit; false for NaN.
[[nodiscard]] bool are_within(std::span<const float> numbers, float limit);
[[nodiscard]] bool are_within(std::span<const double> numbers, double limit);

}  // namespace sdm::sites
