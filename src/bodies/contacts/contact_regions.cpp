#include "bodies/contacts/contact_regions.h"

#include <algorithm>
#include <utility>

#include "closest/single_point.h"
#include "geometry/boxes.h"
#include "sites/closest_on_face.h"

namespace sdm::contacts {
namespace {

// A node is deep if its centre is inside by more than so many radii.
constexpr double kDeep = 2;
constexpr double kRelativeRounding = 1e-9;  // of distances
// Nodes of a part with at most so many leaves are not divided.
constexpr std::uint32_t kWholeLeaves = 16;

using Kind = ContactRegion::Kind;

}  // namespace

struct ContactRegions::Search {
  ContactRegions& regions;

  bool enter(Node& node) const { return node.slot == kNone || regions.divides(node); }
  static std::uint32_t bound(const Node&, const tree::WideTree::Node& node) { return (1u << node.count) - 1; }
  static void leaf(const Node&) {}  // none is divided
};

// A node without near faces is inside or outside as a whole, as far as it is connected. The distance is
// 1-Lipschitz: in a ball whose centre is farther than its radius and the margin, nothing is in contact.
void ContactRegions::find(const shape::Body& on, const shape::Body& other, const mesh::Similarity& to_other,
                          double margin, const pairs::NearFaces& near, int side) {
  on_ = &on;
  other_ = &other;
  to_other_ = &to_other;
  margin_ = margin;
  near_ = &near;
  side_ = side;
  regions_.clear();
  tree::visit(internals(on.sites()).wide, stack_, Search{*this});
  std::ranges::sort(regions_, {}, [](const ContactRegion& r) { return std::pair(r.node, r.first_leaf); });
}

bool ContactRegions::divides(Node& node) {
  const auto [wide_node, i] =
      std::pair(node.slot / tree::WideTree::kWidth, node.slot % tree::WideTree::kWidth);
  const shape::Ball ball = shape::ball_of_child(internals(on_->sites()), wide_node, i, *to_other_);
  if (box_distance({ball.centre, ball.centre}, other_->box()) > ball.radius + margin_) return false;
  const shape::ContactPart& place = on_->contact_parts()[node.source];
  const bool in_part = place.part != kNone;
  const std::uint32_t near_face = find_near_face(place);
  if (near_face != kNone) node.face = near_face;
  Kind kind = in_part ? Kind::part : Kind::coarse;
  bool whole = node.leaf() || (in_part && place.last_leaf - place.first_leaf <= kWholeLeaves);
  if (!whole && near_face == kNone) {
    const Position position = find_position(node, ball, in_part ? 1 : kDeep);
    if (position == Position::free) return false;
    whole = position == Position::inside;
    if (whole) kind = in_part ? Kind::inside : Kind::deep;
  }
  if (whole)
    regions_.push_back({.kind = kind,
                        .node = in_part ? place.part : node.source,
                        .source = node.source,
                        .first_leaf = place.first_leaf,
                        .last_leaf = place.last_leaf,
                        .near_face = node.face});
  return !whole;
}

// Whether all of the node is out of contact, or its centre is inside by more than `depth` radii.
ContactRegions::Position ContactRegions::find_position(Node& node, const shape::Ball& ball,
                                                       double depth) const {
  const sites::SitesData& sites = internals(other_->sites());
  const Vec3& centre = ball.centre;
  const double free = ball.radius + margin_, inside = depth * ball.radius;
  const double known =
      node.face == kNone ? kInfinity : sites::closest_on_face(sites, node.face, centre).distance;
  if (known <= std::min(free, inside)) return Position::undecided;
  // Sets node.known, or returns false if the surface is farther away.
  const auto is_within = [&](double max_distance) {
    const ClosestPoint closest = closest::closest_point(sites, centre, max_distance);
    if (closest.type == SiteType::none) return false;
    node.face = sites.face_of(closest.type, closest.site);
    node.known = {centre, closest.distance, other_->inside()(centre, closest)};
    return true;
  };
  if (!is_within(free)) {
    // The surface does not meet this ball, which is on the side of any other such ball that it overlaps.
    if (!(norm(centre - node.known.centre) < (1 - kRelativeRounding) * (free + node.known.radius)))
      (void)is_within(kInfinity);
    if (!node.known.inside) return Position::free;
    if (inside <= free || !is_within(inside)) return Position::inside;
  }
  return node.known.inside && node.known.radius > inside ? Position::inside : Position::undecided;
}

// A face of the other body that is near to a face of the node, if any.
std::uint32_t ContactRegions::find_near_face(const shape::ContactPart& node) const {
  const std::vector<std::uint32_t>& leaves = near_->leaves[side_];
  const auto first = std::ranges::lower_bound(leaves, node.first_leaf);
  return first != leaves.end() && *first < node.last_leaf ? near_->opposite[side_][*first] : kNone;
}

}  // namespace sdm::contacts
