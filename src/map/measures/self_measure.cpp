#include "map/measures/self_measure.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "geometry/triangle_pair.h"
#include "geometry/vec.h"
#include "tree/visit.h"

namespace sdm::self {

using tree::WideTree;

struct SelfSearch::Scratch {
  std::vector<tree::OpenNode> stack;
  // All 0 between searches.
  std::vector<std::uint16_t> excluded;  ///< of each patch: a bit for each face of the packet that excludes it
  std::vector<std::uint8_t> shut;       ///< of each patch: 1 if all of these exclude it, and the tree is told
  std::vector<std::uint8_t> taken;      ///< of each leaf: the number of its faces in such patches
  std::vector<std::uint8_t> closed;  ///< of each wide node: a bit for each child with nothing but such faces

  static Scratch& of_this_thread() {
    thread_local Scratch scratch;
    return scratch;
  }
};

namespace {

constexpr double kAbove = 1 + 1e-12;  // larger than the rounding error of squares: ties must be compared
constexpr std::uint16_t kAllOfPacket = 0xFFFF;
static_assert(SelfSearch::kPacket == 16);

// Calls visit(row, bits) for rows of patches and which faces of the packet exclude them; a row may come
// several times, with other faces.
template <class Rows, class Visit>
void for_each_row(const Rows& rows, const Visit& visit) {
  for (std::size_t i = 0, end = 0; i < rows.size(); i = end) {
    std::uint32_t bits = 0;
    for (; end < rows.size() && rows[end].data() == rows[i].data(); ++end) bits |= 1u << end;
    visit(rows[i], static_cast<std::uint16_t>(bits));
  }
}

}  // namespace

bool FacePair::before(const FacePair& other) const {
  return std::tie(distance, face1, face2) < std::tie(other.distance, other.face1, other.face2);
}

PatchTree::PatchTree(const sites::SitesData& sites, const Exclusion& exclusion) {
  const Array<std::uint32_t>& leaf_begin = sites.regions.leaves;
  const Array<WideTree::Node>& nodes = sites.wide.nodes;
  const auto leaf_count = static_cast<std::uint32_t>(leaf_begin.size() - 1);
  const auto patch_at = [&](std::uint32_t i) { return exclusion.patch_of(sites.tree.items[i]); };
  place_of_leaf.assign(leaf_count, kNone);
  place_of_node.assign(nodes.size(), kNone);

  // The patch that all faces below belong to, or kNone. The children of a node come after it.
  std::vector<std::uint32_t> of_leaf(leaf_count), of_node(nodes.size());
  for (std::uint32_t leaf = 0; leaf < leaf_count; ++leaf) {
    of_leaf[leaf] = patch_at(leaf_begin[leaf]);
    for (std::uint32_t i = leaf_begin[leaf]; i < leaf_begin[leaf + 1]; ++i)
      if (patch_at(i) != of_leaf[leaf]) of_leaf[leaf] = kNone;
  }
  const auto below = [&](std::uint32_t child) {
    return WideTree::is_leaf(child) ? of_leaf[WideTree::leaf_number(child)] : of_node[child];
  };
  for (auto n = static_cast<std::uint32_t>(nodes.size()); n-- > 0;) {
    of_node[n] = below(nodes[n].child[0]);
    for (std::uint32_t slot = 0; slot < nodes[n].count; ++slot) {
      const std::uint32_t child = nodes[n].child[slot], place = WideTree::kWidth * n + slot;
      (WideTree::is_leaf(child) ? place_of_leaf[WideTree::leaf_number(child)] : place_of_node[child]) = place;
      if (below(child) != of_node[n]) of_node[n] = kNone;
    }
  }
  whole = make_rows<std::uint32_t>(exclusion.patches(), [&](const auto& put) {
    for (std::uint32_t n = 0; n < nodes.size(); ++n)
      for (std::uint32_t slot = 0; slot < nodes[n].count; ++slot)
        if (const std::uint32_t patch = below(nodes[n].child[slot]); patch != kNone && of_node[n] == kNone)
          put(patch, WideTree::kWidth * n + slot);
    // The children of the root stand for a patch that has all faces of the tree.
    for (std::uint32_t slot = 0; !nodes.empty() && of_node[0] != kNone && slot < nodes[0].count; ++slot)
      put(of_node[0], slot);
  });
  part = make_rows<std::uint32_t>(exclusion.patches(), [&](const auto& put) {
    for (std::uint32_t leaf = 0; leaf < leaf_count; ++leaf)
      for (std::uint32_t i = leaf_begin[leaf]; of_leaf[leaf] == kNone && i < leaf_begin[leaf + 1]; ++i)
        put(patch_at(i), leaf);
  });
  patch_of.resize(exclusion.faces());
  for (std::uint32_t face = 0; face < patch_of.size(); ++face) patch_of[face] = exclusion.patch_of(face);
  std::vector<std::uint8_t> listed(exclusion.patches());
  order.reserve(exclusion.patches());
  const auto list = [&](std::uint32_t patch) {
    if (std::exchange(listed[patch], 1) == 0) order.push_back(patch);
  };
  for (const std::uint32_t face : sites.tree.items) list(exclusion.patch_of(face));
  for (std::uint32_t patch = 0; patch < exclusion.patches(); ++patch) list(patch);  // of ignored faces only
}

SelfSearch::SelfSearch(const sites::SitesData& sites, const Exclusion& exclusion, const PatchTree& patches)
    : sites_(sites), exclusion_(exclusion), patches_(patches), scratch_(Scratch::of_this_thread()) {
  const auto at_least = [](auto& marks, std::size_t size) {
    if (marks.size() < size) marks.resize(size);
  };
  at_least(scratch_.excluded, exclusion.patches());
  at_least(scratch_.shut, exclusion.patches());
  at_least(scratch_.taken, patches.place_of_leaf.size());
  at_least(scratch_.closed, patches.place_of_node.size());
}

SelfSearch::~SelfSearch() {
  exclude({});
}

void SelfSearch::start_from(std::span<const std::uint32_t> faces) {
  face_ = faces.front();
  Rows rows;
  bool same = true;
  for (std::size_t i = 0; i < kPacket; ++i) {
    rows[i] = exclusion_.excluded_by(exclusion_.patch_of(faces[std::min(i, faces.size() - 1)]));
    same = same && rows[i].data() == rows_[i].data();
  }
  if (!same) exclude(rows);
}

// Faces that are near each other exclude nearly the same patches: only the others change the tree.
void SelfSearch::exclude(const Rows& rows) {
  for_each_row(rows_, [&](std::span<const std::uint32_t> row, std::uint16_t) {
    for (const std::uint32_t patch : row) scratch_.excluded[patch] = 0;
  });
  for_each_row(rows, [&](std::span<const std::uint32_t> row, std::uint16_t bits) {
    for (const std::uint32_t patch : row) scratch_.excluded[patch] |= bits;
  });
  for (const std::uint32_t patch : rows_[0])
    if (scratch_.shut[patch] != 0 && scratch_.excluded[patch] != kAllOfPacket) admit_patch(patch);
  for (const std::uint32_t patch : rows[0])
    if (scratch_.shut[patch] == 0 && scratch_.excluded[patch] == kAllOfPacket) exclude_patch(patch);
  rows_ = rows;
}

void SelfSearch::exclude_patch(std::uint32_t patch) {
  scratch_.shut[patch] = 1;
  for (const std::uint32_t place : patches_.whole.of(patch)) close(place);
  for (const std::uint32_t leaf : patches_.part.of(patch))
    if (++scratch_.taken[leaf] == sites_.regions.leaves[leaf + 1] - sites_.regions.leaves[leaf])
      close(patches_.place_of_leaf[leaf]);
}

void SelfSearch::admit_patch(std::uint32_t patch) {
  scratch_.shut[patch] = 0;
  for (const std::uint32_t place : patches_.whole.of(patch)) open(place);
  for (const std::uint32_t leaf : patches_.part.of(patch))
    if (scratch_.taken[leaf]-- == sites_.regions.leaves[leaf + 1] - sites_.regions.leaves[leaf])
      open(patches_.place_of_leaf[leaf]);
}

// Closes a child, and the nodes above it that have no other open child.
void SelfSearch::close(std::uint32_t place) {
  while (place != kNone) {
    const std::uint32_t node = place / WideTree::kWidth;
    scratch_.closed[node] |= static_cast<std::uint8_t>(1u << place % WideTree::kWidth);
    if (!all_closed(node)) return;
    place = patches_.place_of_node[node];
  }
}

// Opens a child, and the nodes above it that had no open child.
void SelfSearch::open(std::uint32_t place) {
  while (place != kNone) {
    const std::uint32_t node = place / WideTree::kWidth;
    const bool closed = all_closed(node);
    scratch_.closed[node] &= static_cast<std::uint8_t>(~(1u << place % WideTree::kWidth));
    if (!closed) return;
    place = patches_.place_of_node[node];
  }
}

bool SelfSearch::all_closed(std::uint32_t node) const {
  return scratch_.closed[node] == (1u << sites_.wide.nodes[node].count) - 1;
}

// Calls visit(face) for the faces in leaves whose boxes are within `limit` of `box`; `limit` may shrink
// meanwhile. Depth first, the nearest child first. Skips excluded faces, and nodes with no others.
template <class Visit>
void SelfSearch::visit_near(const Box& box, double& limit, const Visit& visit) const {
  const UnitFrame& frame = sites_.frame;
  const tree::FloatBox unit = tree::FloatBox::around({frame.to_unit(box.lower), frame.to_unit(box.upper)});
  const auto within = [&](float squared) {
    // Distances are too large by 1e-6 of themselves at most, coordinates in the unit frame by 1e-16.
    const double most = (1 + 1e-6) * frame.scale * limit + 1e-15;
    return !(squared > most * most);
  };
  const auto bound = [&](const tree::OpenNode& open, const WideTree::Node& node,
                         float(&squared)[WideTree::kWidth]) {
    squared_distances(node, unit, squared);
    std::uint32_t near = 0;
    for (std::uint32_t i = 0; i < node.count; ++i) near |= (within(squared[i]) ? 1u : 0u) << i;
    return near & ~std::uint32_t{scratch_.closed[open.child]};
  };
  const auto enter = [&](const tree::OpenNode& open) { return within(open.bound); };
  const auto faces = [&](const tree::OpenNode& open) {
    const std::uint32_t leaf = open.leaf_number();
    for (std::uint32_t i = sites_.regions.leaves[leaf]; i < sites_.regions.leaves[leaf + 1]; ++i)
      if (const std::uint32_t face = sites_.tree.items[i]; scratch_.excluded[exclusion_.patch_of(face)] == 0)
        visit(face);
  };
  tree::visit(sites_.wide, scratch_.stack, tree::NearestFirst{bound, enter, faces});
}

std::span<const ClosestPoint> SelfSearch::closest_to(std::span<const Vec3> points, double max_distance) {
  const std::span found = std::span(closest_).first(points.size());
  const closest::ExcludedFaces excluded{patches_.patch_of, scratch_.excluded, scratch_.closed};
  closest::closest_of_packet(sites_, points, max_distance, excluded, found);
  return found;
}

FacePair SelfSearch::nearest(double max_distance, const FacePair& known) const {
  FacePair best;
  const auto too_late = [&](const FacePair& than, std::uint32_t other) {
    return than.distance == 0 &&
           std::pair(than.face1, than.face2) <= std::pair(std::min(face_, other), std::max(face_, other));
  };
  double limit = max_distance;
  const Corners own = corners_of(sites_.mesh, face_);
  Box box;
  for (const Vec3& p : own) extend(box, p);
  visit_near(box, limit, [&](std::uint32_t other) {
    if (too_late(best, other) || too_late(known, other)) return;
    const Corners others = corners_of(sites_.mesh, other);
    if (squared_box_distance(own, others) > kAbove * limit * limit) return;
    const bool first = face_ < other;  // the same order, and so the same rounding, from either face
    const PointPair c = first ? closest_or_common(own, others) : closest_or_common(others, own);
    const FacePair pair{std::sqrt(c.squared), std::min(face_, other), std::max(face_, other), c.point1,
                        c.point2};
    if (pair.distance <= limit && pair.before(best)) {
      best = pair;
      limit = pair.distance;
    }
  });
  return best;
}

namespace {

const Exclusion& checked(const Mesh& mesh, const Sites& sites, const SelfOptions& options) {
  if (sites.mesh().triangles.size() != options.exclusion.faces())
    throw Error("the exclusion belongs to another mesh: its number of faces differs");
  check_options(SelfProximityOptions{.max_distance = options.max_distance});
  if (mesh.triangles.size() != options.exclusion.faces())
    throw Error("surface and sites belong to different meshes: their numbers of faces differ");
  return options.exclusion;
}

class FaceSelfSearch final : public map::FaceSearch {
 public:
  FaceSelfSearch(const sites::SitesData& sites, const Exclusion& exclusion, const PatchTree& patches,
                 double max_distance)
      : search_(sites, exclusion, patches), max_distance_(max_distance) {}

  void start(std::span<const map::Sample> samples) override {
    samples_ = samples;
    found_.clear();
    for (std::size_t i = 0; i < samples.size(); i += SelfSearch::kPacket) {
      points_.clear();
      faces_.clear();
      for (const map::Sample& s : samples.subspan(i, std::min(SelfSearch::kPacket, samples.size() - i))) {
        points_.push_back(s.point);
        faces_.push_back(s.face);
      }
      search_.start_from(faces_);
      const std::span<const ClosestPoint> found = search_.closest_to(points_, max_distance_);
      found_.insert(found_.end(), found.begin(), found.end());
    }
  }
  map::Value value(std::size_t i) override {
    map::Value value{.closest = found_[i]};
    value.vector = value.closest.point - samples_[i].point;
    return value;
  }

 private:
  SelfSearch search_;
  double max_distance_;
  std::span<const map::Sample> samples_;
  std::vector<Vec3> points_;          // of a packet
  std::vector<std::uint32_t> faces_;  // of these
  std::vector<ClosestPoint> found_;   // of all samples
};

}  // namespace

SelfMeasure::SelfMeasure(const Mesh& mesh, const Sites& sites, const SelfOptions& options)
    : sites_(internals(sites)),
      exclusion_(checked(mesh, sites, options)),
      max_distance_(options.max_distance),
      patches_(sites_, exclusion_) {
  description = {.measured = {.kind = DistanceKind::self,
                              .text = "distance to the closest point of faces that are not excluded",
                              .settings = settings_of(SelfProximityOptions{.max_distance = max_distance_})},
                 .sign = {SignMethod::none, "the distance of a surface to itself has no sign"},
                 .no_value = {.distance = std::numeric_limits<float>::infinity(), .vector = 0}};
  progress = options.progress;
  // The faces of a patch exclude the same.
  std::vector<std::uint32_t> place(exclusion_.patches());
  for (std::uint32_t i = 0; i < place.size(); ++i) place[patches_.order[i]] = i;
  groups.resize(exclusion_.faces());
  for (std::uint32_t face = 0; face < groups.size(); ++face) groups[face] = place[exclusion_.patch_of(face)];
}

std::unique_ptr<map::FaceSearch> SelfMeasure::search() const {
  return std::make_unique<FaceSelfSearch>(sites_, exclusion_, patches_, max_distance_);
}

bool SelfMeasure::counts_at_vertices(std::uint32_t face) const {
  return !sites_.topology.ignored(face);
}

}  // namespace sdm::self
