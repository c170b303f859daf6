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

}  // namespace sdm::gpu
