#include "bodies/shape/contact_parts.h"

#include "tree/fold.h"

namespace sdm::shape {

std::vector<ContactPart> contact_parts(const tree::AabbTree& tree) {
  const auto size = [&](std::uint32_t node) {
    const tree::FloatBox& box = tree.box(node);
    return norm({double{box.upper[0]} - box.lower[0], double{box.upper[1]} - box.lower[1],
                 double{box.upper[2]} - box.lower[2]});
  };
  std::vector<ContactPart> parts(tree.nodes.size());
  if (parts.empty()) return parts;
  const tree::LeafOrder leaves(tree);
  const double largest = kContactPart * size(0);
  tree::Subtree part;
  const auto enter = [&](tree::Subtree subtree) {
    if (subtree.root >= part.end && size(subtree.root) <= largest) part = subtree;
    parts[subtree.root] = {subtree.root < part.end ? part.root : kNone, leaves.before[subtree.root],
                           leaves.before[subtree.end]};
    return true;
  };
  tree::visit(tree, tree::InOrder{enter, [](std::uint32_t) {}});
  return parts;
}

}  // namespace sdm::shape
