#include "proximity/shape/contact_parts.h"

#include "core/geometry/vec.h"
#include "hierarchy/traverse.h"

namespace sdm::shape {

std::vector<std::uint32_t> contact_parts(const sites::SitesData& sites) {
  std::vector<std::uint32_t> parts(sites.mesh.positions.size(), kNone);
  if (sites.tree.nodes.empty()) return parts;
  const auto size = [&](std::uint32_t node) {
    const hierarchy::FloatBox& box = sites.tree.box(node);
    return norm(
        {double{box.hi[0]} - box.lo[0], double{box.hi[1]} - box.lo[1], double{box.hi[2]} - box.lo[2]});
  };
  const double largest = kContactPart * size(0);
  hierarchy::Subtree part;
  const auto enter = [&](hierarchy::Subtree subtree) {
    if (subtree.root >= part.end && size(subtree.root) <= largest) part = subtree;
    return true;
  };
  hierarchy::traverse(sites.tree, hierarchy::whole(sites.tree), enter, [&](std::uint32_t leaf) {
    if (leaf >= part.end) return;
    for (const std::uint32_t face : sites.tree.items_of(leaf))
      for (const std::uint32_t vertex : sites.mesh.triangles[face])
        if (parts[vertex] == kNone) parts[vertex] = part.root;
  });
  return parts;
}

}  // namespace sdm::shape
