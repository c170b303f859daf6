#include "gpu/sites_on_device.h"

#include <algorithm>
#include <vector>

#include "core/memory.h"
#include "geometry/triangle.h"
#include "sites/face_frames.h"

namespace sdm::gpu {
namespace {

// As in shaders/faces.wgsl.
struct ChildBox {
  float lower[3];
  std::uint32_t number;
  float upper[3];
  std::uint32_t padding;
};
struct Face {
  float origin_length[4], along_ac[4], beside_ac[4], normal_ac[4], bc[4];
};
struct Errors {
  float by_coordinate, constant, padding[2];
};
static_assert(sizeof(ChildBox) == 32 && sizeof(Face) == 80 && sizeof(Errors) == 16);

// See docs/design/gpu.md: twice the error of a distance in single precision, of a point at the largest
// coordinate m, is at most kByCoordinate m + kByRadius R, and a part of the distance that kFarther of the
// shader contains.
constexpr float kByCoordinate = 5e-7f, kByRadius = 1.4e-5f;

// The children of each node; kNone where there is none.
std::vector<ChildBox> child_boxes(const tree::WideTree& tree) {
  constexpr std::size_t kWidth = tree::WideTree::kWidth;
  require_memory(tree.nodes.size() * kWidth * sizeof(ChildBox), "the tree of O2 for the gpu engine");
  std::vector<ChildBox> boxes(tree.nodes.size() * kWidth);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const tree::WideTree::Node& node = tree.nodes[i / kWidth];
    const std::size_t slot = i % kWidth;
    boxes[i].number = slot < node.count ? node.child[slot] : kNone;
    for (int k = 0; k < 3; ++k)
      boxes[i].lower[k] = node.lower[k][slot], boxes[i].upper[k] = node.upper[k][slot];
  }
  return boxes;
}

// The frames of the faces in the order of the leaves.
std::vector<Face> face_frames(const sites::SitesData& sites) {
  require_memory(sites.tree.items.size() * sizeof(Face), "the faces of O2 for the gpu engine");
  std::vector<Face> faces(sites.tree.items.size());
  sites::FaceFrames frames;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto [a, b, c] = corners_of(sites.mesh, sites.tree.items[i]);
    frames.set(0, {sites.frame.to_unit(a), sites.frame.to_unit(b), sites.frame.to_unit(c)});
    Face& face = faces[i];
    for (int k = 0; k < 3; ++k) {
      face.origin_length[k] = frames.origin[k][0];
      face.along_ac[k] = frames.along[k][0];
      face.beside_ac[k] = frames.beside[k][0];
      face.normal_ac[k] = frames.normal[k][0];
    }
    face.origin_length[3] = frames.length[0];
    face.along_ac[3] = frames.ac.along[0];
    face.beside_ac[3] = frames.ac.beside[0];
    face.normal_ac[3] = frames.ac.length[0];
    face.bc[0] = frames.bc.along[0];
    face.bc[1] = frames.bc.beside[0];
    face.bc[2] = frames.bc.length[0];
    face.bc[3] = 0;
  }
  return faces;
}

template <class Item>
Buffer upload(Device& device, Device::Use use, std::span<const Item> items, std::string_view purpose) {
  Buffer buffer = device.buffer(items.size_bytes(), use, purpose);
  device.write(buffer, std::as_bytes(items));
  return buffer;
}

}  // namespace

SitesOnDevice::SitesOnDevice(Device& device, const sites::SitesData& sites)
    : shape_number(sites.shape_number) {
  const Errors bounds{kByCoordinate, kByRadius * sites.regions.largest_radius, {}};
  errors = upload(device, Device::Use::uniform, std::span(&bounds, 1), "constants");
  boxes =
      upload(device, Device::Use::read, std::span<const ChildBox>(child_boxes(sites.wide)), "the tree of O2");
  leaves = upload(device, Device::Use::read, std::span<const std::uint32_t>(sites.regions.leaves),
                  "the leaves of O2");
  faces = upload(device, Device::Use::read, std::span<const Face>(face_frames(sites)), "the faces of O2");
}

DistanceError distance_error(const sites::SitesData& sites, double largest_coordinate) {
  return {.each = 3e-6,
          .constant = 0.5 * (kByCoordinate * std::max(largest_coordinate, 1.0) +
                             kByRadius * static_cast<double>(sites.regions.largest_radius))};
}

}  // namespace sdm::gpu
