// The tree and the faces of Sites on a device.
#pragma once

#include <cstdint>

#include "gpu/device/device.h"
#include "sites/sites_data.h"

namespace sdm::gpu {

/// The eight-wide tree and a frame of each face, in single precision in the unit frame of the sites.
struct SitesOnDevice {
  /// Throws sdm::Error if there is not enough memory, here or there.
  SitesOnDevice(Device& device, const sites::SitesData& sites);

  std::uint64_t shape_number;  ///< of SitesData
  Buffer errors, boxes, leaves, faces;
};

/// The error of a distance that a device has computed, in the unit frame: at most `each` of itself, and
/// `constant`, of a point whose coordinates are at most this. See docs/design/gpu.md.
struct DistanceError {
  double each, constant;
};
[[nodiscard]] DistanceError distance_error(const sites::SitesData& sites, double largest_coordinate);

}  // namespace sdm::gpu
