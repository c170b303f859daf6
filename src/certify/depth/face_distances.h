// Distances of a few points to faces.
#pragma once

#include <array>
#include <cstdint>

#include "sites/sites_data.h"

namespace sdm::depth {

/// The distances of four points to each of two faces, to rounding: eight at once, for the price of one of
/// closest_on_face().
[[nodiscard]] std::array<std::array<double, 4>, 2> face_distances(const sites::SitesData& sites,
                                                                  const std::array<Vec3, 4>& points,
                                                                  const std::array<std::uint32_t, 2>& faces);

}  // namespace sdm::depth
