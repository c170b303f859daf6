#include "closest/descent.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "closest/descent.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "closest/site_lists-inl.h"
#include "closest/work_counts.h"

#ifndef SDM_DESCENT_ONCE
#define SDM_DESCENT_ONCE
namespace sdm::closest {
namespace {

// A shared candidate list pays off where the group has at least this many points for each leaf of O2's tree
// within the bound, or at most kFewPoints points. Otherwise its subgroups are traversed separately.
// (Measured.)
constexpr std::size_t kPointsPerLeaf = 14, kFewPoints = 64;
// Scattered points have no use for a list: with more leaves than this for each, the points of a packet are
// searched one at a time. (Measured.)
constexpr std::size_t kLeavesPerPoint = 4;
// Lists of up to this many sites are evaluated for all packets of a ball instead of being filtered further:
// more where there are only four packets. (Measured.)
constexpr std::size_t few_sites(int level) {
  return level == 1 ? 8 : 3;
}

}  // namespace
}  // namespace sdm::closest
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::closest::HWY_NAMESPACE {

// The closest point of O2 to c found so far, with its squared distance; until one is found, a bound and c
// itself.
struct Nearest {
  float squared;
  float point[3];
  bool found;
};

template <class Some>
HWY_INLINE void improve(Nearest& nearest, const Some& block, const float* p) {
  const Block d;
  for (size_t i = 0; i < block.count; i += hn::Lanes(d)) {
    const BlockVec s = hn::IfThenElse(hn::FirstN(d, block.count - i), squared(d, block, i, p), hn::Inf(d));
    if (hn::AllFalse(d, hn::Lt(s, hn::Set(d, nearest.squared)))) continue;
    nearest.squared = hn::GetLane(hn::MinOfLanes(d, s));
    nearest.found = true;
    const auto lane = hn::FindKnownFirstTrue(d, hn::Eq(s, hn::Set(d, nearest.squared)));
    closest(block, i + static_cast<size_t>(lane), p, nearest.point);
  }
}

template <class Some>
HWY_INLINE void improve(Nearest& nearest, const SiteList<Some>& list, const float* p) {
  for (size_t i = 0; i < list.used; ++i) improve(nearest, list.blocks[i], p);
}

// c − b for a point c and the closest points b to it in a node's boxes.
struct FromBoxes {
  BlockVec x, y, z, squared;

  HWY_INLINE FromBoxes(Block d, const tree::WideTree::Node& node, size_t i, const float* c) {
    const auto from = [&](int k) HWY_ATTR {
      const BlockVec p = hn::Set(d, c[k]);
      return hn::Sub(p, hn::Min(hn::Max(p, hn::Load(d, node.lower[k] + i)), hn::Load(d, node.upper[k] + i)));
    };
    x = from(0);
    y = from(1);
    z = from(2);
    squared = square_norm(d, x, y, z);
  }
};

class Search {
 public:
  Search(const tree::WideTree& tree, const sites::Regions& regions, float limit, Descent& descent)
      : tree_(tree), regions_(regions), limit_(limit), s_(descent) {}

  // Finds the winners of a ball's points by one traversal for all of them, or by one for each of its child
  // balls.
  void start(int level, size_t index) {
    const Ball& ball = s_.points.balls[level][index];
    SiteLists& lists = s_.lists[level];
    lists.clear();
    count_work(&WorkCounts::groups);
    Nearest nearest = within_limit(ball);
    if (last_.found && squared_distance(ball, last_.point) < nearest.squared) {  // the previous group is near
      nearest = last_;
      nearest.squared = squared_distance(ball, last_.point);
    }
    improve_in_tree(nearest, ball.centre);
    if (nearest.found) last_ = nearest;
    const CandidateBound bound(ball, nearest.squared, nearest.point, limit_);
    const size_t points = PointGroup::points_at(level);
    const size_t most_leaves = points > kFewPoints ? points / kPointsPerLeaf : points * kLeavesPerPoint;
    if (!find_leaves(bound, most_leaves)) {
      if (level == 0) {
        std::fill_n(s_.winners + PointGroup::kPacket * index, PointGroup::kPacket, SiteId::kUnsettled);
        return;
      }
      for_children(level, index, [&](size_t child) { start(level - 1, child); });
      return;
    }
    collect(bound, lists);
    descend(level, index);
  }

 private:
  Nearest within_limit(const Ball& ball) const {
    const float within = limit_ + enlarged_radius(ball);
    return {within * within, {ball.centre[0], ball.centre[1], ball.centre[2]}, false};
  }

  static float squared_distance(const Ball& ball, const float (&p)[3]) {
    float squared = 0;
    for (int k = 0; k < 3; ++k) squared += (ball.centre[k] - p[k]) * (ball.centre[k] - p[k]);
    return squared;
  }

  template <class Visit>
  void for_children(int level, size_t index, const Visit& visit) const {
    const size_t first = PointGroup::kFan * index;
    const size_t end = std::min(first + PointGroup::kFan, s_.points.balls[level - 1].size());
    for (size_t child = first; child < end; ++child) visit(child);
  }

  // Improves `nearest` to the closest centre of a face to p.
  void improve_in_tree(Nearest& nearest, const float* p) {
    const auto bound = [&](const tree::OpenNode&, const tree::WideTree::Node& node, float* squared) HWY_ATTR {
      count_work(&WorkCounts::nodes);
      return select(node.count, [&](size_t i) HWY_ATTR {
        const Block d;
        const FromBoxes from(d, node, i, p);
        hn::Store(from.squared, d, squared + i);
        return hn::Lt(from.squared, hn::Set(d, nearest.squared));
      });
    };
    const auto enter = [&](const tree::OpenNode& open) { return open.bound < nearest.squared; };
    const auto improve = [&](const tree::OpenNode& leaf)
                             HWY_ATTR { improve_by_centres(nearest, leaf.leaf_number(), p); };
    tree::visit(tree_, s_.stack, tree::NearestFirst{bound, enter, improve});
  }

  void improve_by_centres(Nearest& nearest, uint32_t leaf, const float* p) const {
    const Block d;
    const sites::FaceBounds& bounds = regions_.bounds[leaf];
    const uint32_t count = faces_in(leaf);
    for (size_t i = 0; i < count; i += hn::Lanes(d)) {
      const auto from = [&](int k)
                            HWY_ATTR { return hn::Sub(hn::Set(d, p[k]), hn::Load(d, bounds.centre[k] + i)); };
      const BlockVec s =
          hn::IfThenElse(hn::FirstN(d, count - i), square_norm(d, from(0), from(1), from(2)), hn::Inf(d));
      if (hn::AllFalse(d, hn::Lt(s, hn::Set(d, nearest.squared)))) continue;
      nearest.squared = hn::GetLane(hn::MinOfLanes(d, s));
      nearest.found = true;
      const auto lane =
          i + static_cast<size_t>(hn::FindKnownFirstTrue(d, hn::Eq(s, hn::Set(d, nearest.squared))));
      for (int k = 0; k < 3; ++k) nearest.point[k] = bounds.centre[k][lane];
    }
  }

  uint32_t faces_in(uint32_t leaf) const { return regions_.leaves[leaf + 1] - regions_.leaves[leaf]; }

  // Finds the leaves of the tree within the bound, as children of nodes. Returns false if there are more than
  // `most`. Not by tree::visit(): without an order, the children of a node are appended to both lists eight
  // at a time by vector instructions, which costs less than a branch for each.
  bool find_leaves(const CandidateBound& bound, size_t most) {
    auto& open = s_.open;
    open.assign(1, 0);
    s_.leaves.clear();
    while (!open.empty()) {
      const tree::WideTree::Node& node = tree_.nodes[open.back()];
      open.pop_back();
      count_work(&WorkCounts::nodes);
      const uint32_t near = select(node.count, [&](size_t i) HWY_ATTR {
        const Block d;
        const FromBoxes from(d, node, i, bound.centre);
        return bound.holds(d, from.squared, from.x, from.y, from.z);
      });
      append(s_.leaves, node.child, near & node.leaves);
      append(open, node.child, near & ~node.leaves);
      if (s_.leaves.size() > most) return false;
    }
    return true;
  }

  // Collects the candidates from the leaves found: first by bounds on all sites that a face owns, then one by
  // one.
  void collect(const CandidateBound& bound, SiteLists& lists) {
    count_work(&WorkCounts::leaves, s_.leaves.size());
    s_.owners.clear();
    for (const uint32_t child : s_.leaves) {
      const uint32_t leaf = tree::WideTree::leaf_number(child), first = regions_.leaves[leaf];
      uint32_t places[SiteBlock::kWidth];
      for (uint32_t lane = 0; lane < SiteBlock::kWidth; ++lane) places[lane] = first + lane;
      append(s_.owners, places, select(faces_in(leaf), [&](size_t lane) HWY_ATTR {
               return may_be_closest(Block(), regions_.bounds[leaf], lane, bound);
             }));
    }
    // A face owns at most three edges and three vertices, so none of these stores needs a branch.
    s_.edges.resize(3 * s_.owners.size());
    s_.vertices.resize(3 * s_.owners.size());
    uint32_t *edge = s_.edges.data(), *vertex = s_.vertices.data();
    for (const uint32_t owner : s_.owners) {
      const sites::Regions::Owner &own = regions_.owners[owner], &next = regions_.owners[owner + 1];
      for (uint32_t k = 0; k < 3; ++k) {
        edge[k] = own.edges + k;
        vertex[k] = own.vertices + k;
      }
      edge += next.edges - own.edges;
      vertex += next.vertices - own.vertices;
    }
    s_.edges.resize(static_cast<size_t>(edge - s_.edges.data()));
    s_.vertices.resize(static_cast<size_t>(vertex - s_.vertices.data()));

    const sites::Regions& r = regions_;
    SiteLists& all = s_.gathered;
    gather(
        s_.owners, r.faces, [&](uint32_t i) { return SiteId::of(SiteType::face, r.owners[i].face); },
        all.faces);
    gather(
        s_.edges, r.edges, [&](uint32_t i) { return SiteId::of(SiteType::edge, r.edges[i].edge); },
        all.edges);
    gather(
        s_.vertices, r.vertices,
        [&](uint32_t i) { return SiteId::of(SiteType::vertex, r.vertices[i].vertex); }, all.vertices);
    count_work(&WorkCounts::gathered, all.size());
    keep(all, bound, lists);
  }

  static void keep(const SiteLists& from, const CandidateBound& bound, SiteLists& to) {
    HWY_NAMESPACE::keep(from.faces, bound, to.faces);
    HWY_NAMESPACE::keep(from.edges, bound, to.edges);
    HWY_NAMESPACE::keep(from.vertices, bound, to.vertices);
  }

  // Finds the winners of a ball's points in the candidate lists of its level.
  void descend(int level, size_t index) {
    const SiteLists& lists = s_.lists[level];
    if (level == 0 || lists.size() <= few_sites(level)) {
      const size_t packets = PointGroup::points_at(level) / PointGroup::kPacket;
      const size_t end = std::min((index + 1) * packets, s_.points.packets);
      for (size_t packet = index * packets; packet < end; ++packet) evaluate(lists, packet);
      return;
    }
    for_children(level, index, [&](size_t child) HWY_ATTR {
      filter(lists, s_.points.balls[level - 1][child], s_.lists[level - 1]);
      descend(level - 1, child);
    });
  }

  void filter(const SiteLists& from, const Ball& ball, SiteLists& to) {
    Nearest nearest = within_limit(ball);
    improve(nearest, from.faces, ball.centre);
    improve(nearest, from.edges, ball.centre);
    improve(nearest, from.vertices, ball.centre);
    count_work(&WorkCounts::list_blocks, from.faces.used + from.edges.used + from.vertices.used);
    const CandidateBound bound(ball, nearest.squared, nearest.point, limit_);
    keep(from, bound, to);
  }

  void evaluate(const SiteLists& lists, size_t packet) {
    const size_t first = PointGroup::kPacket * packet;
    uint32_t* winners = s_.winners + first;
    std::fill_n(winners, PointGroup::kPacket, lists.size() == 0 ? kNone : SiteId::kUnsettled);
    alignas(64) float best[PointGroup::kPacket];
    std::fill_n(best, PointGroup::kPacket, std::numeric_limits<float>::infinity());
    count_work(&WorkCounts::evaluations, lists.size());
    // The first of equal distances wins: at the end of an edge its vertex, at the border of a face its edge.
    offer(lists.vertices, first, best, winners);
    offer(lists.edges, first, best, winners);
    offer(lists.faces, first, best, winners);
  }

  // Evaluates every site of a list for the points of a packet.
  template <class Some>
  void offer(const SiteList<Some>& list, size_t first, float* best, uint32_t* winners) const {
    const Points d;
    const hn::RebindToUnsigned<Points> du;
    for (size_t i = 0; i < PointGroup::kPacket; i += hn::Lanes(d)) {
      const auto at = [&](int k) HWY_ATTR { return hn::Load(d, s_.points.position[k] + first + i); };
      const PointVec x = at(0), y = at(1), z = at(2);
      PointVec least = hn::Load(d, best + i);
      auto winner = hn::LoadU(du, winners + i);
      for (size_t b = 0; b < list.used; ++b)
        for (uint32_t lane = 0; lane < list.blocks[b].count; ++lane) {
          const PointVec s = squared(d, list.blocks[b], lane, x, y, z);
          const auto closer = hn::Lt(s, least);
          const uint32_t site = list.blocks[b].id[lane];
          least = hn::IfThenElse(closer, s, least);
          winner = hn::IfThenElse(hn::RebindMask(du, closer), hn::Set(du, site), winner);
        }
      hn::Store(least, d, best + i);
      hn::StoreU(winner, du, winners + i);
    }
  }

  const tree::WideTree& tree_;
  const sites::Regions& regions_;
  const float limit_;
  Descent& s_;
  Nearest last_{0, {}, false};  // from the previous traversal
};

void FindWinners(const tree::WideTree& tree, const sites::Regions& regions, float limit, Descent& descent) {
  Search(tree, regions, limit, descent).start(descent.points.top, 0);
}

}  // namespace sdm::closest::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::closest {

HWY_EXPORT(FindWinners);

void find_winners(const tree::WideTree& tree, const sites::Regions& regions, float limit, Descent& descent) {
  HWY_DYNAMIC_DISPATCH(FindWinners)(tree, regions, limit, descent);
}

}  // namespace sdm::closest
#endif
