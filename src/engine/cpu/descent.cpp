#include "engine/cpu/descent.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/descent.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <array>
#include <bit>
#include <limits>
#include <type_traits>

#include "engine/cpu/region_kernels-inl.h"

#ifndef SDM_DESCENT_ONCE
#define SDM_DESCENT_ONCE
namespace sdm {
namespace {

// A list for a group is worth its traversal where the group has so many points for each leaf of O2's tree
// within reach, or is as small as kFewPoints; else its parts fare better with traversals of their own.
// (Measured.)
constexpr std::size_t kPointsPerLeaf = 12, kFewPoints = 64;
// Sites that are evaluated at once, rather than filtered any further.
constexpr std::size_t kFewSites = 3;

// For each mask of eight bits, the positions of the bits that are set, a byte each.
constexpr std::array<std::uint64_t, 256> kPositions = [] {
  std::array<std::uint64_t, 256> table{};
  for (unsigned mask = 0; mask < 256; ++mask)
    for (unsigned bit = 0, count = 0; bit < 8; ++bit)
      if (mask >> bit & 1) table[mask] |= std::uint64_t{bit} << (8 * count++);
  return table;
}();

// A block's rows, one after the other, its sites' numbers, and the list that it goes into.
template <class Block>
struct Rows;
template <>
struct Rows<FaceBlock> {
  static constexpr SiteType kType = SiteType::face;
  static constexpr int kCount = 16;
  static auto* first(auto& block) { return block.plane[0]; }
  static auto* sites(auto& block) { return block.face; }
  static auto& list(SiteLists& lists) { return lists.faces; }
};
template <>
struct Rows<EdgeBlock> {
  static constexpr SiteType kType = SiteType::edge;
  static constexpr int kCount = 15;
  static auto* first(auto& block) { return block.start[0]; }
  static auto* sites(auto& block) { return block.edge; }
  static auto& list(SiteLists& lists) { return lists.edges; }
};
template <>
struct Rows<VertexBlock> {
  static constexpr SiteType kType = SiteType::vertex;
  static constexpr int kCount = 3 + 3 * VertexBlock::kRays;
  static auto* first(auto& block) { return block.point[0]; }
  static auto* sites(auto& block) { return block.vertex; }
  static auto& list(SiteLists& lists) { return lists.vertices; }
};

}  // namespace
}  // namespace sdm
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::HWY_NAMESPACE {

// Runs test(i) → mask over the lanes of a block and returns the first `count` results as bits.
template <class Test>
HWY_INLINE uint32_t select(uint32_t count, const Test& test) {
  const Block d;
  uint32_t bits = 0;
  for (size_t i = 0; i < RegionBlock::kWidth; i += hn::Lanes(d)) {
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, test(i), bytes);
    bits |= static_cast<uint32_t>(bytes[0]) << i;
  }
  return bits & ((1u << count) - 1);
}

// Appends the sites of a block whose bits are set: they fill the list's last block, and then another.
template <class SiteBlock>
void append(SiteList<SiteBlock>& list, const SiteBlock& block, uint32_t bits) {
  using R = Rows<SiteBlock>;
  constexpr uint32_t kWidth = RegionBlock::kWidth;
  if (list.used + 1 >= list.blocks.size()) list.blocks.resize(2 * list.blocks.size() + 2);
  if (list.used == 0 || list.blocks[list.used - 1].count == kWidth) list.blocks[list.used++].count = 0;
  SiteBlock &last = list.blocks[list.used - 1], &next = list.blocks[list.used];
  const uint32_t filled = last.count, total = filled + static_cast<uint32_t>(std::popcount(bits));
  last.count = std::min(total, kWidth);
  if (total > kWidth) {
    next.count = total - kWidth;
    ++list.used;
  }
  const float* from = R::first(block);
  float *to = R::first(last), *overflow = R::first(next);
  if constexpr (hn::MaxLanes(Block()) < kWidth) {
    for (uint32_t at = filled; bits != 0; bits &= bits - 1, ++at) {
      const int lane = std::countr_zero(bits);
      float* out = at < kWidth ? to + at : overflow + (at - kWidth);
      for (uint32_t row = 0; row < R::kCount; ++row) out[kWidth * row] = from[kWidth * row + lane];
      (at < kWidth ? R::sites(last)[at] : R::sites(next)[at - kWidth]) = R::sites(block)[lane];
    }
  } else {
    // One permutation moves the sites to the lanes from `filled` on, and those that are too many to the
    // front, which is where they belong in the next block.
    const Block d;
    const hn::RebindToUnsigned<Block> du;
    const hn::Rebind<uint8_t, Block> bytes;
    const uint64_t positions = std::rotl(kPositions[bits], static_cast<int>(8 * filled));
    const auto indices = hn::PromoteTo(du, hn::LoadU(bytes, reinterpret_cast<const uint8_t*>(&positions)));
    const auto move = [&](auto tag, const auto* row, auto* out, auto* out_next) HWY_ATTR {
      const auto moved = hn::TableLookupLanes(hn::LoadU(tag, row), hn::IndicesFromVec(tag, indices));
      hn::StoreU(hn::IfThenElse(hn::FirstN(tag, filled), hn::LoadU(tag, out), moved), tag, out);
      if (total > kWidth) hn::StoreU(moved, tag, out_next);
    };
    for (uint32_t row = 0; row < R::kCount; ++row)
      move(d, from + kWidth * row, to + kWidth * row, overflow + kWidth * row);
    move(du, R::sites(block), R::sites(last), R::sites(next));
  }
}

// Appends the sites of a block that matter.
template <class SiteBlock>
HWY_INLINE void keep(const SiteBlock& block, const Reach& reach, SiteList<SiteBlock>& list) {
  const uint32_t bits =
      select(block.count, [&](size_t i) HWY_ATTR { return matters(Block(), block, i, reach); });
  if (bits != 0) append(list, block, bits);
}

template <class SiteBlock>
void keep(const SiteList<SiteBlock>& from, const Reach& reach, SiteList<SiteBlock>& to) {
  to.used = 0;
  for (size_t i = 0; i < from.used; ++i) keep(from.blocks[i], reach, to);
}

// The point of O2 that is closest to c so far, with the square of the distance; else a bound, and c itself.
struct Nearest {
  float squared;
  float point[3];
  bool found;
};

template <class SiteBlock>
HWY_INLINE void improve(Nearest& nearest, const SiteBlock& block, const float* p) {
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

template <class SiteBlock>
HWY_INLINE void improve(Nearest& nearest, const SiteList<SiteBlock>& list, const float* p) {
  for (size_t i = 0; i < list.used; ++i) improve(nearest, list.blocks[i], p);
}

// c − b for a point c and the points b of a node's boxes that are closest to it.
struct FromBoxes {
  BlockVec x, y, z, squared;

  HWY_INLINE FromBoxes(Block d, const WideTree::Node& node, size_t i, const float* c) {
    const auto from = [&](int k) HWY_ATTR {
      const BlockVec p = hn::Set(d, c[k]);
      return hn::Sub(p, hn::Min(hn::Max(p, hn::Load(d, node.lo[k] + i)), hn::Load(d, node.hi[k] + i)));
    };
    x = from(0), y = from(1), z = from(2);
    squared = square_norm(d, x, y, z);
  }
};

// Calls visit(block) for all blocks of a leaf of the tree.
template <class Visit>
HWY_INLINE void for_each_block(const Regions& regions, uint32_t leaf, const Visit& visit) {
  const Regions::Leaf &first = regions.leaves[leaf], &last = regions.leaves[leaf + 1];
  for (uint32_t b = first.faces; b < last.faces; ++b) visit(regions.faces[b]);
  for (uint32_t b = first.edges; b < last.edges; ++b) visit(regions.edges[b]);
  for (uint32_t b = first.vertices; b < last.vertices; ++b) visit(regions.vertices[b]);
}

class Search {
 public:
  Search(const WideTree& tree, const Regions& regions, float limit, Descent& descent)
      : tree_(tree), regions_(regions), limit_(limit), s_(descent) {}

  // Finds the winners of a ball's points by a traversal for them all, or for each of the balls below.
  void start(int level, size_t index) {
    const Ball& ball = s_.points.balls[level][index];
    SiteLists& lists = s_.lists[level];
    lists.clear();
    ++s_.counts.groups;
    Nearest nearest = within_limit(ball);
    if (last_.found && squared_distance(ball, last_.point) < nearest.squared)  // the group before lies near
      nearest = last_, nearest.squared = squared_distance(ball, last_.point);
    improve_in_tree(nearest, ball.centre);
    if (nearest.found) last_ = nearest;
    const Reach reach(ball, nearest.squared, nearest.point, limit_);
    const size_t points = PointGroup::points_at(level);
    const size_t most_leaves =
        points > kFewPoints ? points / kPointsPerLeaf : std::numeric_limits<size_t>::max();
    if (!find_leaves(reach, most_leaves)) {
      for_children(level, index, [&](size_t child) { start(level - 1, child); });
      return;
    }
    collect(reach, lists);
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

  // Best first: the point of O2 closest to p.
  void improve_in_tree(Nearest& nearest, const float* p) {
    auto& stack = s_.stack;
    stack.assign(1, {0, 0});
    while (!stack.empty()) {
      const Descent::Entry entry = stack.back();
      stack.pop_back();
      if (!(entry.squared < nearest.squared)) continue;
      if (entry.child & WideTree::kLeafBit) {
        for_each_block(regions_, entry.child & ~WideTree::kLeafBit,
                       [&](const auto& block) HWY_ATTR { improve(nearest, block, p); });
        continue;
      }
      ++s_.counts.nodes;
      const WideTree::Node& node = tree_.nodes[entry.child];
      alignas(64) float squared[WideTree::kWidth];
      uint32_t near = select(node.count, [&](size_t i) HWY_ATTR {
        const Block d;
        const FromBoxes from(d, node, i, p);
        hn::Store(from.squared, d, squared + i);
        return hn::Lt(from.squared, hn::Set(d, nearest.squared));
      });
      const auto base = static_cast<std::ptrdiff_t>(stack.size());
      for (; near != 0; near &= near - 1) {  // the nearest on top
        const int slot = std::countr_zero(near);
        const Descent::Entry child{node.child[slot], squared[slot]};
        auto at = stack.end();
        while (at != stack.begin() + base && (at - 1)->squared < child.squared) --at;
        stack.insert(at, child);
      }
    }
  }

  // The leaves of the tree that come within reach, in their order. Returns false if there are more than
  // `most`.
  bool find_leaves(const Reach& reach, size_t most) {
    auto& stack = s_.stack;
    stack.assign(1, {0, 0});
    s_.leaves.clear();
    while (!stack.empty()) {
      const uint32_t child = stack.back().child;
      stack.pop_back();
      if (child & WideTree::kLeafBit) {
        s_.leaves.push_back(child & ~WideTree::kLeafBit);
        if (s_.leaves.size() > most) return false;
        continue;
      }
      ++s_.counts.nodes;
      const WideTree::Node& node = tree_.nodes[child];
      uint32_t near = select(node.count, [&](size_t i) HWY_ATTR {
        const Block d;
        const FromBoxes from(d, node, i, reach.centre);
        return reach.holds(d, from.squared, from.x, from.y, from.z);
      });
      for (; near != 0; near &= ~std::bit_floor(near))  // the first on top
        stack.push_back({node.child[std::bit_width(near) - 1], 0});
    }
    return true;
  }

  void collect(const Reach& reach, SiteLists& lists) {
    for (size_t i = 0; i < s_.leaves.size(); ++i) {
      if (i + 1 < s_.leaves.size())  // their memory is far away
        for_each_block(regions_, s_.leaves[i + 1], [](const auto& block) {
          for (size_t byte = 0; byte < sizeof block; byte += 64)
            hwy::Prefetch(reinterpret_cast<const char*>(&block) + byte);
        });
      for_each_block(regions_, s_.leaves[i], [&](const auto& block) HWY_ATTR {
        ++s_.counts.tree_blocks;
        keep(block, reach, Rows<std::remove_cvref_t<decltype(block)>>::list(lists));
      });
    }
  }

  // Finds the winners of a ball's points in the lists of its level.
  void descend(int level, size_t index) {
    const SiteLists& lists = s_.lists[level];
    if (level == 0 || lists.size() <= kFewSites) {
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
    s_.counts.list_blocks += from.faces.used + from.edges.used + from.vertices.used;
    const Reach reach(ball, nearest.squared, nearest.point, limit_);
    keep(from.faces, reach, to.faces);
    keep(from.edges, reach, to.edges);
    keep(from.vertices, reach, to.vertices);
  }

  void evaluate(const SiteLists& lists, size_t packet) {
    const size_t first = PointGroup::kPacket * packet;
    uint32_t* winners = s_.winners + first;
    std::fill_n(winners, PointGroup::kPacket, lists.size() == 0 ? kNone : SiteId::kUnsettled);
    alignas(64) float best[PointGroup::kPacket];
    std::fill_n(best, PointGroup::kPacket, std::numeric_limits<float>::infinity());
    s_.counts.evaluations += lists.size();
    // Of equals the first wins: at the end of an edge its vertex, at the border of a face its edge.
    offer(lists.vertices, first, best, winners);
    offer(lists.edges, first, best, winners);
    offer(lists.faces, first, best, winners);
  }

  // Offers every site of a list to the points of a packet.
  template <class SiteBlock>
  void offer(const SiteList<SiteBlock>& list, size_t first, float* best, uint32_t* winners) const {
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
          const SiteId site =
              SiteId::of(Rows<SiteBlock>::kType, Rows<SiteBlock>::sites(list.blocks[b])[lane]);
          least = hn::IfThenElse(closer, s, least);
          winner = hn::IfThenElse(hn::RebindMask(du, closer), hn::Set(du, site.packed), winner);
        }
      hn::Store(least, d, best + i);
      hn::StoreU(winner, du, winners + i);
    }
  }

  const WideTree& tree_;
  const Regions& regions_;
  const float limit_;
  Descent& s_;
  Nearest last_{0, {}, false};  // of the last traversal
};

void FindWinners(const WideTree& tree, const Regions& regions, float limit, Descent& descent) {
  Search(tree, regions, limit, descent).start(descent.points.top, 0);
}

}  // namespace sdm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm {

HWY_EXPORT(FindWinners);

void find_winners(const WideTree& tree, const Regions& regions, float limit, Descent& descent) {
  HWY_DYNAMIC_DISPATCH(FindWinners)(tree, regions, limit, descent);
}

}  // namespace sdm
#endif
