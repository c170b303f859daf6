#include "engine/cpu/packet.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/packet.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace sdm::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Lanes over the packet's points, and over the sites or boxes of a block.
using Points = hn::CappedTag<float, Packet::kSize>;
using Block = hn::CappedTag<float, RegionBlock::kWidth>;
using PointVec = hn::Vec<Points>;
using BlockVec = hn::Vec<Block>;
static_assert(WideTree::kWidth == RegionBlock::kWidth);

template <typename D>
HWY_INLINE hn::Vec<D> square_norm3(D, hn::Vec<D> x, hn::Vec<D> y, hn::Vec<D> z) {
  return hn::MulAdd(z, z, hn::MulAdd(y, y, hn::Mul(x, x)));
}

// Distance of p to the interval [lo, hi] along one axis.
template <typename D>
HWY_INLINE hn::Vec<D> gap(D d, hn::Vec<D> lo, hn::Vec<D> hi, hn::Vec<D> p_lo, hn::Vec<D> p_hi) {
  return hn::Max(hn::Max(hn::Sub(lo, p_hi), hn::Sub(p_lo, hi)), hn::Zero(d));
}

// plane·(p, −1) for eight planes and one point.
HWY_INLINE BlockVec height(Block d, const float (&plane)[4][RegionBlock::kWidth], size_t i, const float* p) {
  BlockVec h = hn::Sub(hn::Mul(hn::Load(d, plane[0] + i), hn::Set(d, p[0])), hn::Load(d, plane[3] + i));
  h = hn::MulAdd(hn::Load(d, plane[1] + i), hn::Set(d, p[1]), h);
  return hn::MulAdd(hn::Load(d, plane[2] + i), hn::Set(d, p[2]), h);
}

// plane·(p, −1) for one plane and many points.
HWY_INLINE PointVec height(Points d, const float (&plane)[4][RegionBlock::kWidth], int lane, PointVec x,
                           PointVec y, PointVec z) {
  PointVec h = hn::MulSub(hn::Set(d, plane[0][lane]), x, hn::Set(d, plane[3][lane]));
  h = hn::MulAdd(hn::Set(d, plane[1][lane]), y, h);
  return hn::MulAdd(hn::Set(d, plane[2][lane]), z, h);
}

template <typename Mask>
HWY_INLINE uint32_t bits_of(Block d, Mask mask, size_t i) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return static_cast<uint32_t>(bytes[0]) << i;
}

// Runs test(i) → mask over the lanes of a block and returns the first `count` results as bits.
template <typename Test>
HWY_INLINE uint32_t select(uint32_t count, const Test& test) {
  const Block d;
  uint32_t bits = 0;
  for (size_t i = 0; i < RegionBlock::kWidth; i += hn::Lanes(d)) bits |= bits_of(d, test(d, i), i);
  return bits & ((1u << count) - 1);
}

// Calls body(lane) for every bit that is set.
template <typename Body>
HWY_INLINE void for_each_bit(uint32_t bits, const Body& body) {
  for (; bits != 0; bits &= bits - 1) body(std::countr_zero(bits));
}

// A site can matter to the packet only if the packet's sphere meets its region and comes within `reach` of
// the bounds.

uint32_t select_faces(const FaceBlock& block, const Packet& p, float reach) {
  return select(block.count, [&](Block d, size_t i) HWY_ATTR {
    const BlockVec inner = hn::Set(d, -p.radius);
    auto pass = hn::Le(hn::Abs(height(d, block.plane, i, p.centre)), hn::Set(d, reach));
    for (const auto& wall : block.wall) pass = hn::And(pass, hn::Ge(height(d, wall, i, p.centre), inner));
    return pass;
  });
}

uint32_t select_edges(const EdgeBlock& block, const Packet& p, float reach) {
  return select(block.count, [&](Block d, size_t i) HWY_ATTR {
    BlockVec r[3], t = hn::Zero(d);
    for (int k = 0; k < 3; ++k) {
      r[k] = hn::Sub(hn::Set(d, p.centre[k]), hn::Load(d, block.start[k] + i));
      t = hn::MulAdd(r[k], hn::Load(d, block.direction[k] + i), t);
    }
    const BlockVec radius = hn::Set(d, p.radius), length = hn::Load(d, block.length + i);
    auto pass = hn::And(hn::Ge(t, hn::Neg(radius)), hn::Le(t, hn::Add(length, radius)));
    for (const auto& wall : block.wall) pass = hn::And(pass, hn::Le(height(d, wall, i, p.centre), radius));
    const BlockVec s = hn::Min(hn::Max(t, hn::Zero(d)), length);
    for (int k = 0; k < 3; ++k) r[k] = hn::NegMulAdd(s, hn::Load(d, block.direction[k] + i), r[k]);
    return hn::And(pass, hn::Le(square_norm3(d, r[0], r[1], r[2]), hn::Set(d, reach * reach)));
  });
}

uint32_t select_vertices(const VertexBlock& block, const Packet& p, float reach) {
  return select(block.count, [&](Block d, size_t i) HWY_ATTR {
    BlockVec r[3];
    for (int k = 0; k < 3; ++k) r[k] = hn::Sub(hn::Set(d, p.centre[k]), hn::Load(d, block.point[k] + i));
    auto pass = hn::Le(square_norm3(d, r[0], r[1], r[2]), hn::Set(d, reach * reach));
    for (const auto& ray : block.ray) {
      BlockVec along = hn::Mul(r[0], hn::Load(d, ray[0] + i));
      along = hn::MulAdd(r[1], hn::Load(d, ray[1] + i), along);
      along = hn::MulAdd(r[2], hn::Load(d, ray[2] + i), along);
      pass = hn::And(pass, hn::Le(along, hn::Set(d, p.radius)));
    }
    return pass;
  });
}

// Offers a site at squared(d, x, y, z) to every point of the packet. A site's distance is never less than
// that of its closed face, so that no region has to be tested exactly but the face's prism, outside of which
// its plane is too close.
template <typename Squared>
HWY_INLINE void offer(Packet& p, uint32_t face, const Squared& squared) {
  const Points d;
  const hn::RebindToUnsigned<Points> du;
  for (size_t i = 0; i < Packet::kSize; i += hn::Lanes(d)) {
    const PointVec best = hn::Load(d, p.best + i);
    const PointVec s = squared(d, hn::Load(d, p.position[0] + i), hn::Load(d, p.position[1] + i),
                               hn::Load(d, p.position[2] + i));
    const auto closer = hn::Lt(s, best);
    hn::Store(hn::IfThenElse(closer, s, best), d, p.best + i);
    hn::Store(hn::IfThenElse(hn::RebindMask(du, closer), hn::Set(du, face), hn::Load(du, p.face + i)), du,
              p.face + i);
  }
}

void offer_face(Packet& p, const FaceBlock& block, int lane) {
  offer(p, block.face[lane], [&](Points d, PointVec x, PointVec y, PointVec z) HWY_ATTR {
    const PointVec h = height(d, block.plane, lane, x, y, z);
    const PointVec inner =
        hn::Min(hn::Min(height(d, block.wall[0], lane, x, y, z), height(d, block.wall[1], lane, x, y, z)),
                height(d, block.wall[2], lane, x, y, z));
    return hn::IfThenElse(hn::Ge(inner, hn::Zero(d)), hn::Mul(h, h), hn::Inf(d));
  });
}

void offer_edge(Packet& p, const EdgeBlock& block, int lane) {
  offer(p, block.face[lane], [&](Points d, PointVec x, PointVec y, PointVec z) HWY_ATTR {
    const PointVec ux = hn::Set(d, block.direction[0][lane]), uy = hn::Set(d, block.direction[1][lane]),
                   uz = hn::Set(d, block.direction[2][lane]);
    x = hn::Sub(x, hn::Set(d, block.start[0][lane]));
    y = hn::Sub(y, hn::Set(d, block.start[1][lane]));
    z = hn::Sub(z, hn::Set(d, block.start[2][lane]));
    PointVec t = hn::MulAdd(z, uz, hn::MulAdd(y, uy, hn::Mul(x, ux)));
    t = hn::Min(hn::Max(t, hn::Zero(d)), hn::Set(d, block.length[lane]));
    return square_norm3(d, hn::NegMulAdd(t, ux, x), hn::NegMulAdd(t, uy, y), hn::NegMulAdd(t, uz, z));
  });
}

void offer_vertex(Packet& p, const VertexBlock& block, int lane) {
  offer(p, block.face[lane], [&](Points d, PointVec x, PointVec y, PointVec z) HWY_ATTR {
    return square_norm3(d, hn::Sub(x, hn::Set(d, block.point[0][lane])),
                        hn::Sub(y, hn::Set(d, block.point[1][lane])),
                        hn::Sub(z, hn::Set(d, block.point[2][lane])));
  });
}

void update_bound(Packet& p) {
  const Points d;
  PointVec largest = hn::Load(d, p.best);
  for (size_t i = hn::Lanes(d); i < Packet::kSize; i += hn::Lanes(d))
    largest = hn::Max(largest, hn::Load(d, p.best + i));
  p.bound = hn::GetLane(hn::MaxOfLanes(d, largest));
}

void visit_leaf(const Regions& regions, uint32_t leaf, Packet& p) {
  const Regions::Leaf &first = regions.leaves[leaf], &last = regions.leaves[leaf + 1];
  const float reach = std::sqrt(p.bound) + p.radius;
  for (uint32_t b = first.faces; b < last.faces; ++b)
    for_each_bit(select_faces(regions.faces[b], p, reach),
                 [&](int lane) HWY_ATTR { offer_face(p, regions.faces[b], lane); });
  for (uint32_t b = first.edges; b < last.edges; ++b)
    for_each_bit(select_edges(regions.edges[b], p, reach),
                 [&](int lane) HWY_ATTR { offer_edge(p, regions.edges[b], lane); });
  for (uint32_t b = first.vertices; b < last.vertices; ++b)
    for_each_bit(select_vertices(regions.vertices[b], p, reach),
                 [&](int lane) HWY_ATTR { offer_vertex(p, regions.vertices[b], lane); });
  update_bound(p);
}

// Pushes the children of a node whose boxes come closer to the packet's box than its bound, the nearest on
// top.
void visit_node(const WideTree& tree, uint32_t index, const Packet& p, std::vector<Traversal::Entry>& stack) {
  const WideTree::Node& node = tree.nodes[index];
  alignas(32) float bound[WideTree::kWidth], order[WideTree::kWidth];
  const uint32_t near = select(node.count, [&](Block d, size_t i) HWY_ATTR {
    BlockVec to_box = hn::Zero(d), to_centre = hn::Zero(d);
    for (int k = 0; k < 3; ++k) {
      const BlockVec lo = hn::Load(d, node.lo[k] + i), hi = hn::Load(d, node.hi[k] + i);
      const BlockVec centre = hn::Set(d, p.centre[k]);
      const BlockVec box_gap = gap(d, lo, hi, hn::Set(d, p.lo[k]), hn::Set(d, p.hi[k]));
      const BlockVec centre_gap = gap(d, lo, hi, centre, centre);
      to_box = hn::MulAdd(box_gap, box_gap, to_box);
      to_centre = hn::MulAdd(centre_gap, centre_gap, to_centre);
    }
    hn::Store(to_box, d, bound + i);
    hn::Store(to_centre, d, order + i);
    return hn::Lt(to_box, hn::Set(d, p.bound));
  });
  const size_t base = stack.size();
  for_each_bit(near, [&](int slot) {
    const Traversal::Entry entry{index, static_cast<uint32_t>(slot), bound[slot], order[slot]};
    auto at = stack.end();
    while (at != stack.begin() + static_cast<std::ptrdiff_t>(base) && (at - 1)->order < entry.order) --at;
    stack.insert(at, entry);
  });
}

// Whether a child's box is closer to any point than that point's own bound: for packets far from O2, where
// the shell between the nearest and the farthest point's bounds holds hundreds of faces, this is what keeps
// the traversal short.
bool any_closer(const WideTree::Node& node, uint32_t slot, const Packet& p) {
  const Points d;
  for (size_t i = 0; i < Packet::kSize; i += hn::Lanes(d)) {
    PointVec squared = hn::Zero(d);
    for (int k = 0; k < 3; ++k) {
      const PointVec x = hn::Load(d, p.position[k] + i);
      const PointVec g = gap(d, hn::Set(d, node.lo[k][slot]), hn::Set(d, node.hi[k][slot]), x, x);
      squared = hn::MulAdd(g, g, squared);
    }
    if (!hn::AllFalse(d, hn::Lt(squared, hn::Load(d, p.best + i)))) return true;
  }
  return false;
}

void Traverse(const WideTree& tree, const Regions& regions, Packet& packet, Traversal& traversal) {
  auto& stack = traversal.stack;
  stack.clear();
  update_bound(packet);
  visit_node(tree, 0, packet, stack);
  while (!stack.empty()) {
    const Traversal::Entry entry = stack.back();
    stack.pop_back();
    if (!(entry.bound < packet.bound) || !any_closer(tree.nodes[entry.node], entry.slot, packet)) continue;
    const uint32_t child = tree.nodes[entry.node].child[entry.slot];
    if (child & WideTree::kLeafBit)
      visit_leaf(regions, child & ~WideTree::kLeafBit, packet);
    else
      visit_node(tree, child, packet, stack);
  }
}

}  // namespace sdm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm {

HWY_EXPORT(Traverse);

void Packet::place(std::span<const Vec3f> points) {
  float magnitude = 0, squared_radius = 0;
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < kSize; ++i) position[k][i] = points[std::min<std::size_t>(i, points.size() - 1)][k];
    lo[k] = *std::min_element(position[k], position[k] + kSize);
    hi[k] = *std::max_element(position[k], position[k] + kSize);
    centre[k] = 0.5f * (lo[k] + hi[k]);
    magnitude = std::max({magnitude, std::abs(lo[k]), std::abs(hi[k])});
  }
  for (int i = 0; i < kSize; ++i) {
    float squared = 0;
    for (int k = 0; k < 3; ++k) squared += (position[k][i] - centre[k]) * (position[k][i] - centre[k]);
    squared_radius = std::max(squared_radius, squared);
  }
  // Heights over planes err by a few units in the last place of the coordinates: O2's are at most 1, the
  // points' `magnitude`.
  radius = 1.0001f * std::sqrt(squared_radius) + 1e-6f * (1 + magnitude);
}

void Packet::start(float limit, const Vec3f* seed, std::uint32_t seed_face) {
  for (int i = 0; i < kSize; ++i) {
    best[i] = limit;
    face[i] = kNone;
    if (seed == nullptr) continue;
    float squared = 0;
    for (int k = 0; k < 3; ++k) squared += (position[k][i] - (*seed)[k]) * (position[k][i] - (*seed)[k]);
    if (squared < limit) best[i] = squared, face[i] = seed_face;
  }
}

void traverse(const WideTree& tree, const Regions& regions, Packet& packet, Traversal& traversal) {
  HWY_DYNAMIC_DISPATCH(Traverse)(tree, regions, packet, traversal);
}

}  // namespace sdm
#endif
