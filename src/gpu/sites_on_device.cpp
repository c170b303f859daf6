#include "gpu/sites_on_device.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

#include "geometry/vec.h"
#include "gpu/shaders.h"

namespace sdm::gpu {
namespace {

template <class Item>
Buffer upload(Device& device, Device::Use use, std::span<const Item> items, std::string_view purpose) {
  Buffer buffer = device.buffer(items.size_bytes(), use, purpose);
  device.write(buffer, std::as_bytes(items));
  return buffer;
}

SitesOnDevice::Level level(Device& device, std::uint32_t first, std::uint32_t count) {
  const PartOfMap constants{.first = first, .count = count};
  return {upload(device, Device::Use::uniform, std::span(&constants, 1), "constants"), count};
}

std::vector<std::uint32_t> children_of(const tree::WideTree& tree) {
  std::vector<std::uint32_t> children;
  children.reserve(tree.nodes.size() * tree::WideTree::kWidth);
  for (const tree::WideTree::Node& node : tree.nodes)
    children.insert(children.end(), node.child, node.child + tree::WideTree::kWidth);
  return children;
}

// Programs take a share of the items each: the number of workgroups is limited.
std::uint32_t workgroups_for(std::size_t items) {
  return static_cast<std::uint32_t>(std::clamp<std::size_t>((items + 63) / 64, 1, 32768));
}

}  // namespace

RefitPrograms::RefitPrograms(Device& device)
    : faces(device.pipeline({kFacesWgsl, kPartWgsl, kFaceSitesWgsl, kRefitFacesWgsl})),
      boxes(device.pipeline({kFacesWgsl, kPartWgsl, kFaceSitesWgsl, kRefitBoxesWgsl})) {}

SitesOnDevice::SitesOnDevice(Device& device, const sites::SitesData& sites)
    : shape_number(sites.shape_number),
      frame(sites.frame),
      shape(sites),
      triangles_(sites.mesh.triangles.begin(), sites.mesh.triangles.end()),
      items_(sites.tree.items.begin(), sites.tree.items.end()),
      children_(children_of(sites.wide)),
      used_(sites.mesh.positions.size(), 0) {
  for (const std::uint32_t face : items_)
    for (const std::uint32_t v : triangles_[face]) used_[v] = 1;
  using Use = Device::Use;
  const Errors bounds = errors_of(shape);
  errors = upload(device, Use::uniform, std::span(&bounds, 1), "constants");
  for (std::uint32_t leaf = 0; leaf != kNone;) {
    const PackedSites packed(sites, leaf, device.most_bytes());
    const auto faces = static_cast<std::uint32_t>(packed.faces.size());
    Part& part = parts.emplace_back(
        Part{.first = packed.first,
             .boxes = upload(device, Use::read, std::span(packed.boxes), "the tree of O2"),
             .leaves = upload(device, Use::read, std::span(packed.leaves), "the leaves of O2"),
             .faces = upload(device, Use::read, std::span(packed.faces), "the faces of O2"),
             .face_sites = upload(device, Use::read, std::span(packed.face_sites), "the sites of O2"),
             .nodes = upload(device, Use::read, std::span(packed.nodes), "the levels of the tree of O2"),
             .all_faces = level(device, 0, faces),
             .levels = {}});
    std::uint32_t first = 0;
    for (const std::uint32_t count : packed.level_counts) {
      part.levels.push_back(level(device, first, count));
      first += count;
    }
    leaf = packed.end_leaf;
  }
}

bool SitesOnDevice::has_tree_of(const sites::SitesData& sites) const {
  constexpr std::size_t kWidth = tree::WideTree::kWidth;
  if (!std::ranges::equal(triangles_, sites.mesh.triangles) ||
      !std::ranges::equal(items_, sites.tree.items) || children_.size() != kWidth * sites.wide.nodes.size())
    return false;
  for (std::size_t n = 0; n < sites.wide.nodes.size(); ++n)
    if (!std::equal(children_.begin() + kWidth * n, children_.begin() + kWidth * (n + 1),
                    sites.wide.nodes[n].child))
      return false;
  return true;
}

UnitFrame SitesOnDevice::frame_of(std::span<const Vec3> positions) const {
  if (positions.size() != used_.size())
    throw Error("O2 has " + std::to_string(used_.size()) + " vertices, not " +
                std::to_string(positions.size()));
  Box box;
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (used_[v] != 0) extend(box, positions[v]);
  return UnitFrame::of(box);
}

void SitesOnDevice::refit(Device& device, const RefitPrograms& programs, std::span<const Vec3> positions,
                          const UnitFrame& moved) {
  using Use = Device::Use;
  std::vector<float> placed(3 * positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (used_[v] == 0) continue;
    const Vec3 unit = moved.to_unit(positions[v]);
    if (!finite(unit)) throw Error("vertex " + std::to_string(v) + " of O2 is not finite");
    for (int k = 0; k < 3; ++k) placed[3 * v + k] = static_cast<float>(unit[k]);
  }
  if (!positions_) {
    positions_ = device.buffer(placed.size() * sizeof(float), Use::read, "the vertices of O2");
    read_back_ = device.buffer(sizeof(Errors), Use::read_back, "constants");
  }
  device.write(positions_, std::as_bytes(std::span(placed)));
  Errors left = errors_of(ShapeErrors(0, 0));
  device.write(errors, std::as_bytes(std::span(&left, 1)));

  std::vector<BindGroup> groups;
  std::vector<Device::Step> steps;
  const auto add = [&](const Pipeline& program, std::size_t items,
                       std::span<const Device::Binding> bindings) {
    groups.push_back(device.bind(program, bindings));
    steps.push_back({&program, nullptr, workgroups_for(items)});
  };
  for (const Part& part : parts) {
    const Device::Binding sites{8, &part.face_sites}, vertices{9, &positions_};
    const Device::Binding of_faces[] = {
        {0, &errors}, {6, &part.faces}, {7, &part.all_faces.constants}, sites, vertices};
    add(programs.faces, part.all_faces.nodes, of_faces);
    for (const Level& each : part.levels) {
      const Device::Binding of_boxes[] = {
          {2, &part.leaves}, {5, &part.nodes}, {6, &part.boxes}, {7, &each.constants}, sites, vertices};
      add(programs.boxes, std::size_t{8} * each.nodes, of_boxes);
    }
  }
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i].group = &groups[i];
  device.run(steps, errors, read_back_, std::as_writable_bytes(std::span(&left, 1)));
  frame = moved;
  shape = refitted_errors(left);
}

}  // namespace sdm::gpu
