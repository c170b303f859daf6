#include "gpu/sites_on_device.h"

#include <span>
#include <string_view>

#include "gpu/packed_sites.h"

namespace sdm::gpu {
namespace {

template <class Item>
Buffer upload(Device& device, Device::Use use, std::span<const Item> items, std::string_view purpose) {
  Buffer buffer = device.buffer(items.size_bytes(), use, purpose);
  device.write(buffer, std::as_bytes(items));
  return buffer;
}

}  // namespace

SitesOnDevice::SitesOnDevice(Device& device, const sites::SitesData& sites)
    : shape_number(sites.shape_number) {
  using Use = Device::Use;
  const Errors bounds = errors_of(sites);
  errors = upload(device, Use::uniform, std::span(&bounds, 1), "constants");
  for (std::uint32_t leaf = 0; leaf != kNone;) {
    const PackedSites part(sites, leaf, device.most_bytes());
    parts.push_back({.first = part.first,
                     .boxes = upload(device, Use::read, std::span(part.boxes), "the tree of O2"),
                     .leaves = upload(device, Use::read, std::span(part.leaves), "the leaves of O2"),
                     .faces = upload(device, Use::read, std::span(part.faces), "the faces of O2")});
    leaf = part.end_leaf;
  }
}

}  // namespace sdm::gpu
