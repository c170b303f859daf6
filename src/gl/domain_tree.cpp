#include "gl/domain_tree.h"

#include <sdm/gl.h>

#include <algorithm>
#include <cmath>

#include "closest/closest_points.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "gl/face_domains.h"

namespace sdm::gl {
namespace {

constexpr std::size_t kNodeGrain = 1024;

Box box_of(const PlanarDomain& domain) {
  Box box;
  for (const Vec2& corner : domain.outline.corners()) extend(box, domain.point(corner));
  return box;
}

void raise_to_root(DomainTree& tree) {
  for_each_bottom_up(
      tree.tree, [](std::uint32_t) {},
      [&](std::uint32_t node, std::uint32_t left, std::uint32_t right) {
        tree.bound[node] = std::max(tree.bound[left], tree.bound[right]);
      });
}

}  // namespace

DomainTree::DomainTree(const Surface& surface, const TileTree& tile_tree, const UnitFrame& frame)
    : tree(tile_tree.tree), leaves(tree), bound(tree.nodes.size()) {
  const surface::Tiles& tiles = tile_tree.tiles;
  std::vector<Box> boxes(tiles.count());
  parallel_for(boxes.size(), kNodeGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      boxes[i] = box_of(face_domain(surface, tiles, static_cast<std::uint32_t>(i), frame, GlClip::planes));
  });
  refit(tree, boxes);
}

void set_bounds(DomainTree& tree, double bound) {
  std::fill(tree.bound.begin(), tree.bound.end(), bound);
}

void set_bounds(DomainTree& tree, const sites::SitesData& sites, double slack, double largest) {
  const std::vector<std::uint32_t> nodes = leaf_nodes(tree.tree);
  const UnitFrame& frame = sites.frame;
  parallel_for(nodes.size(), kNodeGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> middles;
    for (std::size_t i = begin; i < end; ++i) {
      const tree::FloatBox& box = tree.tree.box(nodes[i]);
      Vec3 middle;
      for (int k = 0; k < 3; ++k)
        middle[k] = 0.5 * (double{box.lower[k]} + box.upper[k]) / frame.scale + frame.origin[k];
      middles.push_back(middle);
    }
    const auto bound = [&](std::size_t first, const sites::ClosestPacket& closest) {
      for (std::size_t i = 0; i < closest.count; ++i) {
        const std::uint32_t node = nodes[begin + first + i];
        const tree::FloatBox& box = tree.tree.box(node);
        const Vec3 p = frame.to_unit(closest.get(i, middles[first + i]).point);
        Vec3 farthest;
        for (int k = 0; k < 3; ++k)
          farthest[k] = std::max(std::abs(box.lower[k] - p[k]), std::abs(box.upper[k] - p[k]));
        tree.bound[node] = std::min(largest, norm(farthest) + slack);
      }
    };
    closest::closest_points(sites, middles, kInfinity, bound);
  });
  raise_to_root(tree);
}

}  // namespace sdm::gl
