// The tree and the faces of Sites on a device.
#pragma once

#include <cstdint>
#include <vector>

#include "gpu/device/device.h"
#include "sites/sites_data.h"

namespace sdm::gpu {

/// The eight-wide tree and a frame of each face, in single precision in the unit frame of the sites: as one
/// tree, or as several of some leaves each where the device does not bind as much memory at once.
struct SitesOnDevice {
  /// Throws sdm::Error if there is not enough memory, here or there.
  SitesOnDevice(Device& device, const sites::SitesData& sites);

  struct Part {
    std::uint32_t first;  ///< of its faces, in the order of the leaves of all
    Buffer boxes, leaves, faces;
  };

  std::uint64_t shape_number;  ///< of SitesData
  Buffer errors;
  std::vector<Part> parts;
};

/// The error of a distance that a device has computed, in the unit frame: at most `each` of itself, and
/// `constant`, of a point whose coordinates are at most this. See docs/design/gpu.md.
struct DistanceError {
  double each, constant;
};
[[nodiscard]] DistanceError distance_error(const sites::SitesData& sites, double largest_coordinate);
/// The same for samples that the device has placed by vertices whose coordinates are at most this.
[[nodiscard]] DistanceError sample_error(const sites::SitesData& sites, double largest_coordinate);

}  // namespace sdm::gpu
