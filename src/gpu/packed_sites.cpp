#include "gpu/packed_sites.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/memory.h"
#include "geometry/triangle.h"
#include "sites/face_frames.h"

namespace sdm::gpu {
namespace {

// See docs/design/gpu.md: twice the error of a distance in single precision, of a point at the largest
// coordinate m, is at most kByCoordinate m + kByRadius R, and a part of the distance that kFarther of the
// shader contains.
constexpr float kByCoordinate = 5e-7f, kByRadius = 1.4e-5f;

// Some leaves that follow each other.
struct LeafRange {
  std::uint32_t first, end;
};

// A node has at least two children, but for those above the first and the last leaf.
constexpr std::size_t kAbove = 2 * tree::kDeepest;
constexpr std::size_t most_nodes(std::size_t leaves) {
  return leaves + kAbove;
}

// The nodes above some leaves, with those of their children that have any of these below them. The number of
// a child is kNone where there is none.
class ChildBoxes {
 public:
  ChildBoxes(const tree::WideTree& tree, LeafRange leaves) : tree_(tree), leaves_(leaves) {
    boxes_.reserve(tree::WideTree::kWidth *
                   std::min(tree.nodes.size(), most_nodes(leaves.end - leaves.first)));
    add(0);
  }

  [[nodiscard]] std::vector<ChildBox> take() { return std::move(boxes_); }

 private:
  // Returns the number of the node here, or kNone if it has no child.
  std::uint32_t add(std::uint32_t number) {
    constexpr std::size_t kWidth = tree::WideTree::kWidth;
    const tree::WideTree::Node& node = tree_.nodes[number];
    const std::size_t place = boxes_.size();
    boxes_.resize(place + kWidth, ChildBox{{}, kNone, {}, 0});
    std::size_t count = 0;
    for (std::uint32_t slot = 0; slot < node.count; ++slot) {
      const std::uint32_t child = child_number(node.child[slot]);
      if (child == kNone) continue;
      ChildBox& box = boxes_[place + count++];
      box.number = child;
      for (int k = 0; k < 3; ++k) box.lower[k] = node.lower[k][slot], box.upper[k] = node.upper[k][slot];
    }
    if (count > 0) return static_cast<std::uint32_t>(place / kWidth);
    boxes_.resize(place);
    return kNone;
  }
  std::uint32_t child_number(std::uint32_t child) {
    if (!tree::WideTree::is_leaf(child)) return add(child);
    const std::uint32_t leaf = tree::WideTree::leaf_number(child);
    return leaf >= leaves_.first && leaf < leaves_.end ? tree::WideTree::leaf(leaf - leaves_.first) : kNone;
  }

  const tree::WideTree& tree_;
  LeafRange leaves_;
  std::vector<ChildBox> boxes_;
};

// The leaves of the part that begins with a leaf: as many as have room in the buffers.
LeafRange part_from(std::uint32_t first, std::span<const std::uint32_t> leaves, std::size_t most_bytes) {
  const std::size_t nodes = most_bytes / (tree::WideTree::kWidth * sizeof(ChildBox));
  const std::size_t most_leaves = nodes > kAbove ? nodes - kAbove : 1;
  const std::size_t most_faces = most_bytes / sizeof(Face);
  std::uint32_t end = first + 1;
  while (end + 1 < leaves.size() && end - first < most_leaves &&
         leaves[end + 1] - leaves[first] <= most_faces)
    ++end;
  return {first, end};
}

// The frames of `count` faces from `first` on, in the order of the leaves.
std::vector<Face> face_frames(const sites::SitesData& sites, std::size_t first, std::size_t count) {
  require_memory(count * sizeof(Face), "the faces of O2 for the gpu engine");
  std::vector<Face> faces(count);
  sites::FaceFrames frames;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto [a, b, c] = corners_of(sites.mesh, sites.tree.items[first + i]);
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

}  // namespace

PackedSites::PackedSites(const sites::SitesData& sites, std::uint32_t first_leaf, std::size_t most_bytes) {
  const std::span<const std::uint32_t> all(sites.regions.leaves);
  require_memory(sites.wide.nodes.size() * tree::WideTree::kWidth * sizeof(ChildBox),
                 "the tree of O2 for the gpu engine");
  const LeafRange range = part_from(first_leaf, all, most_bytes);
  first = all[range.first];
  end_leaf = range.end + 1 < all.size() ? range.end : kNone;
  leaves.assign(all.begin() + range.first, all.begin() + range.end + 1);
  for (std::uint32_t& leaf : leaves) leaf -= first;
  boxes = ChildBoxes(sites.wide, range).take();
  faces = face_frames(sites, first, leaves.back());
}

Errors errors_of(const sites::SitesData& sites) {
  return {kByCoordinate, kByRadius * sites.regions.largest_radius, {}};
}

DistanceError distance_error(const sites::SitesData& sites, double largest_coordinate) {
  return {.each = 3e-6,
          .constant = 0.5 * (kByCoordinate * std::max(largest_coordinate, 1.0) +
                             kByRadius * static_cast<double>(sites.regions.largest_radius))};
}

DistanceError sample_error(const sites::SitesData& sites, double largest_coordinate) {
  constexpr double kByCoordinateOfVertices = 1.7e-6;
  DistanceError error = distance_error(sites, largest_coordinate);
  error.constant += kByCoordinateOfVertices * largest_coordinate;
  return error;
}

}  // namespace sdm::gpu
