#include "proximity/contacts/contact_regions.h"

#include <algorithm>
#include <utility>

#include "core/geometry/sweep.h"
#include "core/geometry/vec.h"

namespace sdm::contacts {
namespace {

// A node is deep if its centre is inside by more than so many radii.
constexpr double kDeep = 2;

using hierarchy::WideTree;

}  // namespace

// A node without near faces is inside or outside as a whole, as far as it is connected. The distance is
// 1-Lipschitz: in a ball whose centre is farther than its radius and the margin, nothing is in contact.
void ContactRegions::find(const shape::Body& on, const shape::Body& other, const mesh::Similarity& to_other,
                          double margin, const exact::NearFaces& near, int side) {
  on_ = &on, other_ = &other, to_other_ = &to_other, margin_ = margin, near_ = &near, side_ = side;
  regions_.clear(), stack_.clear();
  open({});
  while (!stack_.empty()) {
    Node node = stack_.back();
    stack_.pop_back();
    const shape::ContactPart& place = on.contact_parts()[node.source];
    ContactRegion region{.node = place.part, .first_leaf = place.first_leaf, .last_leaf = place.last_leaf};
    const std::uint32_t near_face = find_near_face(place);
    if (near_face != kNone) node.face = near_face;
    if (place.part == kNone) {
      if (near_face == kNone && !WideTree::is_leaf(node.child)) {
        const SurfacePoint centre = measure_near(other, node.ball.centre, node.face);
        if (centre.distance > node.ball.radius + margin) continue;
        node.face = centre.face;
        if (centre.distance < -kDeep * node.ball.radius)
          region.kind = ContactRegion::Kind::deep, region.node = node.source;
      }
      if (region.kind != ContactRegion::Kind::deep) {
        if (!WideTree::is_leaf(node.child)) {
          open(node);
          continue;
        }
        region.kind = ContactRegion::Kind::coarse;
      }
    }
    region.near_face = node.face;
    regions_.push_back(region);
  }
  std::ranges::sort(regions_, {}, [](const ContactRegion& r) { return std::pair(r.node, r.first_leaf); });
}

// A face of the other body that is near to a face of the node, if any.
std::uint32_t ContactRegions::find_near_face(const shape::ContactPart& node) const {
  const std::vector<std::uint32_t>& leaves = near_->leaves[side_];
  const auto first = std::ranges::lower_bound(leaves, node.first_leaf);
  return first != leaves.end() && *first < node.last_leaf ? near_->opposite[side_][*first] : kNone;
}

// Pushes the children that are not beyond the box of the other body.
void ContactRegions::open(const Node& parent) {
  const sites::SitesData& sites = internals(on_->sites());
  const WideTree::Node& wide = sites.wide.nodes[parent.child];
  for (std::uint32_t i = 0; i < wide.count; ++i) {
    const shape::Ball ball = shape::ball_of_child(sites, parent.child, i, *to_other_);
    if (box_distance({ball.centre, ball.centre}, other_->box()) > ball.radius + margin_) continue;
    stack_.push_back({wide.child[i], wide.source[i], ball, parent.face});
  }
}

}  // namespace sdm::contacts
