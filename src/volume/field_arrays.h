// Fields before they have values, and what is counted when they have.
#pragma once

#include <sdm/volume.h>

#include <cstddef>
#include <span>

namespace sdm::volume {

struct NewField {
  double max_distance;
  bool sites;             ///< also arrays for the closest sites
  double relative_error;  ///< of distances, as a fraction of the diagonal of O2's box and the grid
  std::size_t more_bytes_per_point = 0;  ///< that the caller will allocate
};

/// Returns a field without values: its grid, maximum distance, accuracy, bounds of O2, and arrays.
/// Throws sdm::Error for a wrong grid or maximum distance, or if there is not enough memory, which is checked
/// before anything is allocated.
[[nodiscard]] DistanceField new_field(const Sites& o2, const Grid& grid, const NewField& properties);

/// The bytes of its arrays.
[[nodiscard]] std::size_t bytes_of(const DistanceField& field);

/// Cost: linear, all cores.
[[nodiscard]] std::size_t count_without_value(std::span<const float> distances);

}  // namespace sdm::volume
