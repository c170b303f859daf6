#include "query/pair_search.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "query/pair_search.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>

#include "query/triangle_pair.h"
#include "query/unit_maps.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, WideTree::kWidth>;
using Vec = hn::Vec<Lanes>;
using Faces = PairWorkspace::Faces;

HWY_INLINE Vec dot(Lanes d, const Vec (&a)[3], const float (&b)[3]) {
  return hn::MulAdd(a[2], hn::Set(d, b[2]),
                    hn::MulAdd(a[1], hn::Set(d, b[1]), hn::Mul(a[0], hn::Set(d, b[0]))));
}
HWY_INLINE Vec dot(const Vec (&a)[3], const Vec (&b)[3]) {
  return hn::MulAdd(a[2], b[2], hn::MulAdd(a[1], b[1], hn::Mul(a[0], b[0])));
}
HWY_INLINE void load(Lanes d, const float (&rows)[3][Faces::kWidth], size_t i, Vec (&v)[3]) {
  for (int k = 0; k < 3; ++k) v[k] = hn::Load(d, rows[k] + i);
}

// Boxes apart by `gap` along three orthogonal axes: their distance, or minus the least overlap.
HWY_INLINE Vec distance_of_gaps(Lanes d, const Vec (&gap)[3]) {
  const Vec most = hn::Max(hn::Max(gap[0], gap[1]), gap[2]);
  Vec apart[3];
  for (int k = 0; k < 3; ++k) apart[k] = hn::Max(gap[k], hn::Zero(d));
  return hn::IfThenElse(hn::Gt(most, hn::Zero(d)), hn::Sqrt(dot(apart, apart)), most);
}

struct CentredBox {
  float centre[3], half[3];

  explicit CentredBox(const FloatBox& box) {
    for (int k = 0; k < 3; ++k)
      centre[k] = 0.5f * (box.lo[k] + box.hi[k]), half[k] = 0.5f * (box.hi[k] - box.lo[k]);
  }
  // The box around this one in another frame, with what rounding takes away.
  CentredBox(const CentredBox& box, const FrameMap& map) {
    for (int k = 0; k < 3; ++k) {
      centre[k] = map.offset[k], half[k] = map.error;
      for (int j = 0; j < 3; ++j) {
        centre[k] += map.row[k][j] * box.centre[j];
        half[k] += std::abs(map.row[k][j]) * box.half[j];
      }
    }
  }
  float size() const { return half[0] + half[1] + half[2]; }
};

// `separate`: the closest faces are sought, else any that intersect.
template <bool separate>
class Search {
 public:
  Search(const MeshPair& pair, double bound, PairWorkspace& workspace)
      : pair_(pair), sites_{&pair.o1, &pair.o2}, maps_(pair), w_(workspace) {
    best_.distance = bound;
    set_limit();
  }

  Separation run() {
    w_.overlapping.assign(1, {{PairWorkspace::Place{0, 0}, PairWorkspace::Place{0, 0}}, 0});
    w_.apart.clear();
    loaded_[0] = loaded_[1] = kNone;
    PairWorkspace::Entry entry;
    while (!best_.intersecting && next(entry)) {
      const bool leaf[2] = {is_leaf(entry.place[0]), is_leaf(entry.place[1])};
      if (leaf[0] && leaf[1])
        compare_leaves(entry.place[0], entry.place[1]);
      else
        open(entry, leaf[0] ? 1 : leaf[1] ? 0 : larger(entry));
    }
    if (best_.face1 == kNone) return {};
    return best_;
  }

 private:
  // Pairs that overlap have all to be looked at, unless an intersection is found: depth first, for this soon
  // finds one. Of the others the nearest comes first, so that none is looked at but those nearer than the
  // closest faces.
  bool next(PairWorkspace::Entry& entry) {
    auto &overlapping = w_.overlapping, &apart = w_.apart;
    if (!overlapping.empty()) {
      entry = overlapping.back();
      overlapping.pop_back();
      return true;
    }
    if (apart.empty() || apart.front().least > limit_) return false;
    std::pop_heap(apart.begin(), apart.end(), farther);
    entry = apart.back();
    apart.pop_back();
    return true;
  }

  static bool farther(const PairWorkspace::Entry& a, const PairWorkspace::Entry& b) {
    return a.least > b.least;
  }
  static bool is_leaf(const PairWorkspace::Place& place) { return (place.child & WideTree::kLeafBit) != 0; }

  CentredBox box_of(const PairWorkspace::Entry& entry, int side) const {
    return CentredBox(sites_[side]->tree.nodes[entry.place[side].source].box);
  }
  int larger(const PairWorkspace::Entry& entry) const {
    return box_of(entry, 0).size() * maps_.unit[0] < box_of(entry, 1).size() * maps_.unit[1];
  }

  // Tests the boxes in the node of one side against the box of the other.
  void open(const PairWorkspace::Entry& entry, int side) {
    ++w_.counts.nodes;
    const WideTree::Node& node = sites_[side]->wide.nodes[entry.place[side].child];
    const CentredBox other = box_of(entry, 1 - side), seen(other, maps_.to[side]);
    alignas(32) float least[WideTree::kWidth];
    const Lanes d;
    for (size_t i = 0; i < WideTree::kWidth; i += hn::Lanes(d))
      hn::Store(distances(node, i, side, other, seen), d, least + i);

    auto& overlapping = w_.overlapping;
    const auto base = static_cast<std::ptrdiff_t>(overlapping.size());
    for (uint32_t i = 0; i < node.count; ++i) {
      if (least[i] > limit_) continue;
      PairWorkspace::Entry child = entry;
      child.place[side] = {node.child[i], node.source[i]};
      child.least = least[i];
      if (least[i] > 0) {
        w_.apart.push_back(child);
        std::push_heap(w_.apart.begin(), w_.apart.end(), farther);
      } else {  // the deepest on top
        auto at = overlapping.end();
        while (at != overlapping.begin() + base && (at - 1)->least < child.least) --at;
        overlapping.insert(at, child);
      }
    }
  }

  // Lower bounds from axes along the sides of the node's boxes, and along those of the other's.
  HWY_INLINE Vec distances(const WideTree::Node& node, size_t i, int side, const CentredBox& other,
                           const CentredBox& seen) const {
    const Lanes d;
    const Vec half_one = hn::Set(d, 0.5f);
    Vec centre[3], half[3], gap[3];
    for (int k = 0; k < 3; ++k) {
      const Vec lo = hn::Load(d, node.lo[k] + i), hi = hn::Load(d, node.hi[k] + i);
      centre[k] = hn::Mul(half_one, hn::Add(lo, hi));
      half[k] = hn::Mul(half_one, hn::Sub(hi, lo));
      gap[k] = hn::Sub(hn::Abs(hn::Sub(centre[k], hn::Set(d, seen.centre[k]))),
                       hn::Add(half[k], hn::Set(d, seen.half[k])));
    }
    const Vec here = hn::Mul(hn::Set(d, maps_.unit[side]), distance_of_gaps(d, gap));
    if (maps_.aligned) return here;
    const FrameMap& map = maps_.to[1 - side];
    for (int k = 0; k < 3; ++k) {
      const float absolute[3] = {std::abs(map.row[k][0]), std::abs(map.row[k][1]), std::abs(map.row[k][2])};
      const Vec off = hn::Add(dot(d, centre, map.row[k]), hn::Set(d, map.offset[k] - other.centre[k]));
      gap[k] = hn::Sub(hn::Abs(off), hn::Add(dot(d, half, absolute), hn::Set(d, other.half[k] + map.error)));
    }
    return hn::Max(here, hn::Mul(hn::Set(d, maps_.unit[1 - side]), distance_of_gaps(d, gap)));
  }

  // The faces of a leaf, in O1's frame.
  Faces& load_faces(int side, const PairWorkspace::Place& place) {
    Faces& f = w_.faces[side];
    if (loaded_[side] == place.child) return f;
    loaded_[side] = place.child;
    const Regions& regions = sites_[side]->regions;
    const uint32_t leaf = place.child & ~WideTree::kLeafBit;
    f.first = regions.leaves[leaf];
    f.count = regions.leaves[leaf + 1] - f.first;
    for (uint32_t lane = 0; lane < Faces::kWidth; ++lane) {
      const Triangle& corners = regions.places.corners[f.first + std::min(lane, f.count - 1)];
      for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k) f.corner[c][k][lane] = regions.vertices[corners[c]].point[k];
    }
    const Lanes d;
    for (size_t i = 0; i < Faces::kWidth; i += hn::Lanes(d)) prepare(f, side, i);
    return f;
  }

  HWY_INLINE void prepare(Faces& f, int side, size_t i) const {
    const Lanes d;
    Vec corner[3][3];
    for (int c = 0; c < 3; ++c) {
      load(d, f.corner[c], i, corner[c]);
      if (side == 1) {
        const Vec unit[3] = {corner[c][0], corner[c][1], corner[c][2]};
        for (int k = 0; k < 3; ++k) {
          corner[c][k] = hn::Add(dot(d, unit, maps_.to[0].row[k]), hn::Set(d, maps_.to[0].offset[k]));
          hn::Store(corner[c][k], d, f.corner[c][k] + i);
        }
      }
    }
    Vec u[3], v[3], normal[3];
    for (int k = 0; k < 3; ++k) {
      hn::Store(hn::Min(hn::Min(corner[0][k], corner[1][k]), corner[2][k]), d, f.lo[k] + i);
      hn::Store(hn::Max(hn::Max(corner[0][k], corner[1][k]), corner[2][k]), d, f.hi[k] + i);
      u[k] = hn::Sub(corner[1][k], corner[0][k]);
      v[k] = hn::Sub(corner[2][k], corner[0][k]);
    }
    for (int k = 0; k < 3; ++k)
      normal[k] = hn::MulSub(u[(k + 1) % 3], v[(k + 2) % 3], hn::Mul(u[(k + 2) % 3], v[(k + 1) % 3]));
    const Vec squared = dot(normal, normal);
    const Vec inverse =
        hn::IfThenElseZero(hn::Gt(squared, hn::Set(d, 1e-37f)), hn::Div(hn::Set(d, 1.0f), hn::Sqrt(squared)));
    for (int k = 0; k < 3; ++k) {
      normal[k] = hn::Mul(normal[k], inverse);
      hn::Store(normal[k], d, f.normal[k] + i);
    }
    const Vec at[3] = {dot(normal, corner[0]), dot(normal, corner[1]), dot(normal, corner[2])};
    hn::Store(hn::Min(hn::Min(at[0], at[1]), at[2]), d, f.near + i);
    hn::Store(hn::Max(hn::Max(at[0], at[1]), at[2]), d, f.far + i);
  }

  // Extents along the direction between the closest points so far: what lies behind them is no closer.
  void measure_along(Faces& f) const {
    const Lanes d;
    for (size_t i = 0; i < Faces::kWidth; i += hn::Lanes(d)) {
      Vec at[3];
      for (int c = 0; c < 3; ++c) {
        Vec corner[3];
        load(d, f.corner[c], i, corner);
        at[c] = dot(d, corner, direction_);
      }
      hn::Store(hn::Min(hn::Min(at[0], at[1]), at[2]), d, f.along_lo + i);
      hn::Store(hn::Max(hn::Max(at[0], at[1]), at[2]), d, f.along_hi + i);
    }
  }

  void compare_leaves(const PairWorkspace::Place& place1, const PairWorkspace::Place& place2) {
    ++w_.counts.leaf_pairs;
    Faces &a = load_faces(0, place1), &b = load_faces(1, place2);
    measure_along(a);
    measure_along(b);
    const Lanes d;
    for (uint32_t j = 0; j < b.count; ++j) {
      alignas(32) float least[Faces::kWidth];
      for (size_t i = 0; i < Faces::kWidth; i += hn::Lanes(d)) hn::Store(distances(a, i, b, j), d, least + i);
      for (uint32_t i = 0; i < a.count; ++i)
        if (!(least[i] > limit_)) compare(a.first + i, b.first + j, least[i] > 0);
      if (best_.intersecting) return;
    }
  }

  // Lower bounds for faces of O1 and one of O2: from their boxes, along both normals, and along the direction
  // between the closest points so far.
  HWY_INLINE Vec distances(const Faces& a, size_t i, const Faces& b, uint32_t j) const {
    const Lanes d;
    const auto gap_between = [&](Vec lo1, Vec hi1, Vec lo2, Vec hi2)
                                 HWY_ATTR { return hn::Max(hn::Sub(lo2, hi1), hn::Sub(lo1, hi2)); };
    Vec gap[3], normal1[3], corner1[3][3], at[3];
    for (int k = 0; k < 3; ++k)
      gap[k] = gap_between(hn::Load(d, a.lo[k] + i), hn::Load(d, a.hi[k] + i), hn::Set(d, b.lo[k][j]),
                           hn::Set(d, b.hi[k][j]));
    Vec least = distance_of_gaps(d, gap);
    load(d, a.normal, i, normal1);
    for (int c = 0; c < 3; ++c) {
      const float corner2[3] = {b.corner[c][0][j], b.corner[c][1][j], b.corner[c][2][j]};
      at[c] = dot(d, normal1, corner2);
      load(d, a.corner[c], i, corner1[c]);
    }
    least = hn::Max(
        least, gap_between(hn::Load(d, a.near + i), hn::Load(d, a.far + i),
                           hn::Min(hn::Min(at[0], at[1]), at[2]), hn::Max(hn::Max(at[0], at[1]), at[2])));
    const float normal2[3] = {b.normal[0][j], b.normal[1][j], b.normal[2][j]};
    for (int c = 0; c < 3; ++c) at[c] = dot(d, corner1[c], normal2);
    least = hn::Max(least,
                    gap_between(hn::Min(hn::Min(at[0], at[1]), at[2]), hn::Max(hn::Max(at[0], at[1]), at[2]),
                                hn::Set(d, b.near[j]), hn::Set(d, b.far[j])));
    least = hn::Max(least, gap_between(hn::Load(d, a.along_lo + i), hn::Load(d, a.along_hi + i),
                                       hn::Set(d, b.along_lo[j]), hn::Set(d, b.along_hi[j])));
    return hn::Mul(hn::Set(d, maps_.unit[0]), hn::Sub(least, hn::Set(d, maps_.to[0].error)));
  }

  void compare(uint32_t owner1, uint32_t owner2, bool apart) {
    ++w_.counts.triangle_pairs;
    const uint32_t face1 = sites_[0]->tree.items[owner1], face2 = sites_[1]->tree.items[owner2];
    const Corners a = pair_.face1(face1), b = pair_.face2(face2);
    if (!apart && triangles_intersect(a, b)) {
      const Vec3 point = common_point(a, b);
      best_ = {0, true, point, point, face1, face2};
      return;
    }
    if constexpr (separate) {
      const PointPair closest = closest_points(a, b);
      const double distance = std::sqrt(closest.squared);
      if (!(distance < best_.distance || (distance == best_.distance && best_.face1 == kNone))) return;
      best_ = {distance, false, closest.point1, closest.point2, face1, face2};
      set_limit();
    }
  }

  void set_limit() {
    limit_ = maps_.round_up(best_.distance);
    const Vec3 direction = normalized(best_.point2 - best_.point1);
    for (int k = 0; k < 3; ++k) direction_[k] = static_cast<float>(direction[k]);
  }

  const MeshPair& pair_;
  const Sites::Impl* sites_[2];
  const UnitMaps maps_;
  PairWorkspace& w_;
  Separation best_;
  float limit_;  // what is farther does not matter
  float direction_[3];
  uint32_t loaded_[2];
};

Separation FindClosest(const MeshPair& pair, double bound, PairWorkspace& workspace) {
  return Search<true>(pair, bound, workspace).run();
}
Separation FindIntersection(const MeshPair& pair, PairWorkspace& workspace) {
  return Search<false>(pair, 0, workspace).run();
}

}  // namespace sdm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm {

HWY_EXPORT(FindClosest);
HWY_EXPORT(FindIntersection);

Separation find_closest(const MeshPair& pair, double bound, PairWorkspace& workspace) {
  return HWY_DYNAMIC_DISPATCH(FindClosest)(pair, bound, workspace);
}
Separation find_intersection(const MeshPair& pair, PairWorkspace& workspace) {
  return HWY_DYNAMIC_DISPATCH(FindIntersection)(pair, workspace);
}

}  // namespace sdm
#endif
