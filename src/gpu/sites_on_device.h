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

}  // namespace sdm::gpu
