#include "rays/trace.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rays/trace.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <bit>

#include "geometry/barycentric.h"
#include "geometry/line_triangle.h"
#include "rays/unit_ray.h"

#ifndef SDM_TRACE_ONCE
#define SDM_TRACE_ONCE
namespace sdm::rays {
namespace {

// The first parameter of the ray in the face; infinite if there is none.
double meet(const sites::SitesData& sites, const Ray& ray, std::uint32_t face) {
  const auto hit = line_meets_triangle(ray.origin, ray.direction, corners_of(sites.mesh, face));
  if (hit && hit->last >= ray.t_min && hit->first <= ray.t_max) return std::max(hit->first, ray.t_min);
  return kInfinity;
}

}  // namespace
}  // namespace sdm::rays
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::rays::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kWidth = tree::WideTree::kWidth;
static_assert(kWidth == sites::FaceBounds::kWidth);
using Block = hn::CappedTag<float, kWidth>;
using BlockVec = hn::Vec<Block>;

// Evaluates test(i) → mask over eight lanes and returns the first `count` results as a bit mask.
template <class Test>
HWY_INLINE uint32_t select(uint32_t count, const Test& test) {
  const Block d;
  uint32_t bits = 0;
  for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, test(i), bytes);
    bits |= static_cast<uint32_t>(bytes[0]) << i;
  }
  return bits & ((1u << count) - 1);
}

// The boxes of a node's children that the ray may meet; `enter` is set to where it does. T. Ize, Robust BVH
// Ray Traversal, 2013: differences and products have the right sign and a relative error of three roundings;
// what is left of the interval is widened by more than those of both its ends.
HWY_INLINE uint32_t boxes_met(const tree::WideTree::Node& node, const UnitRay& ray, float* enter) {
  return select(node.count, [&](size_t i) HWY_ATTR {
    const Block d;
    BlockVec first = hn::Set(d, ray.begin), last = hn::Set(d, ray.end);
    for (int k = 0; k < 3; ++k) {
      const BlockVec inverse = hn::Set(d, ray.inverse[k]);
      const BlockVec lo =
          hn::Mul(hn::Sub(hn::Load(d, node.lower[k] + i), hn::Set(d, ray.beyond_lo[k])), inverse);
      const BlockVec hi =
          hn::Mul(hn::Sub(hn::Load(d, node.upper[k] + i), hn::Set(d, ray.before_hi[k])), inverse);
      first = hn::Max(first, hn::Min(lo, hi));
      last = hn::Min(last, hn::Max(lo, hi));
    }
    hn::Store(first, d, enter + i);
    return hn::Le(first, hn::Mul(last, hn::Set(d, 1 + 0x1p-20f)));
  });
}

// The faces of a leaf that the ray may meet: it passes through the disc around the face. With q from the
// origin to the centre of the disc, D = n·direction and H = n·q, it meets the plane at s = H / D, and
//   |s direction − q| ≤ radius  ⇔  |H direction − D q| ≤ |D| radius.
// Both sides are below 10, with errors of a few units in the last place and of the ray's own error.
HWY_INLINE uint32_t discs_met(const sites::FaceBounds& bounds, uint32_t count, const UnitRay& ray) {
  return select(count, [&](size_t i) HWY_ATTR {
    const Block d;
    const BlockVec slack = hn::Set(d, 16 * ray.error);
    BlockVec speed = hn::Zero(d), height = hn::Zero(d), q[3];
    for (int k = 0; k < 3; ++k) {
      const BlockVec normal = hn::Load(d, bounds.normal[k] + i);
      q[k] = hn::Sub(hn::Load(d, bounds.centre[k] + i), hn::Set(d, ray.origin[k]));
      speed = hn::MulAdd(normal, hn::Set(d, ray.direction[k]), speed);
      height = hn::MulAdd(normal, q[k], height);
    }
    BlockVec squared = hn::Zero(d);
    for (int k = 0; k < 3; ++k) {
      const BlockVec beside = hn::NegMulAdd(speed, q[k], hn::Mul(height, hn::Set(d, ray.direction[k])));
      squared = hn::MulAdd(beside, beside, squared);
    }
    height = hn::Xor(height, hn::And(speed, hn::SignBit(d)));  // both have the sign of s
    speed = hn::Abs(speed);
    const BlockVec within = hn::MulAdd(speed, hn::Load(d, bounds.radius + i), slack);
    const auto met = hn::Le(squared, hn::Mul(within, within));
    const auto after = hn::Ge(hn::Add(height, slack), hn::Mul(speed, hn::Set(d, ray.begin)));
    const auto before = hn::Le(hn::Sub(height, slack), hn::Mul(speed, hn::Set(d, ray.end)));
    return hn::And(met, hn::And(after, before));
  });
}

// Calls visit(face) for the faces that the ray may meet, roughly from front to back, until it returns true.
template <class Visit>
HWY_INLINE void for_each_face(const sites::SitesData& sites, const UnitRay& ray, Scratch& scratch,
                              const Visit& visit) {
  const sites::Regions& regions = sites.regions;
  const auto bound = [&](const tree::OpenNode&, const tree::WideTree::Node& node, float* from)
                         HWY_ATTR { return boxes_met(node, ray, from); };
  const auto enter = [&](const tree::OpenNode& open) { return open.bound <= ray.end; };
  const auto faces = [&](const tree::OpenNode& open) HWY_ATTR {
    const uint32_t leaf = open.leaf_number(), first = regions.leaves[leaf];
    uint32_t met =
        discs_met(regions.bounds[leaf], regions.leaves[leaf + 1] - first, ray) | regions.thin[leaf];
    for (; met != 0; met &= met - 1)
      if (visit(regions.owners[first + static_cast<uint32_t>(std::countr_zero(met))].face)) return false;
    return true;
  };
  tree::visit(sites.wide, scratch.stack, tree::NearestFirst{bound, enter, faces});
}

// The first hits of faces for which accepts(number of the ray, face).
template <class Accepts>
HWY_INLINE void first_hits_among(const sites::SitesData& sites, std::span<const Ray> rays,
                                 const Accepts& accepts, Scratch& scratch, RayHit* hits) {
  for (size_t i = 0; i < rays.size(); ++i) {
    RayHit& hit = hits[i] = {};
    UnitRay unit;
    if (!unit.place(rays[i], sites.frame)) continue;
    for_each_face(sites, unit, scratch, [&](uint32_t face) HWY_ATTR {
      if (!accepts(i, face)) return false;
      const double t = meet(sites, rays[i], face);
      if (t < hit.t || (t == hit.t && face < hit.face && hit.face != kNone)) {
        hit.t = t;
        hit.face = face;
        unit.end_at(t);
      }
      return false;
    });
    if (hit.face == kNone) continue;
    const auto [a, b, c] = corners_of(sites.mesh, hit.face);
    hit.barycentric = barycentric(a, b, c, rays[i].origin + hit.t * rays[i].direction);
  }
}

void FirstHits(const sites::SitesData& sites, std::span<const Ray> rays, Scratch& scratch, RayHit* hits) {
  first_hits_among(
      sites, rays, [](size_t, uint32_t) { return true; }, scratch, hits);
}

void FirstHitsAmong(const sites::SitesData& sites, std::span<const Ray> rays, const FaceFilter& filter,
                    Scratch& scratch, RayHit* hits) {
  const auto accepts = [&](size_t ray, uint32_t face) { return filter.accepts(filter.data, ray, face); };
  first_hits_among(sites, rays, accepts, scratch, hits);
}

// Calls visit(face) for the faces below these nodes that the ray may meet, until it returns true.
template <class Visit>
HWY_INLINE void for_each_face_below(const sites::SitesData& sites, std::span<const tree::WideTree::Node> from,
                                    const UnitRay& ray, std::vector<uint32_t>& stack, const Visit& visit) {
  alignas(64) float enter[kWidth];
  stack.clear();
  // Whether to go on.
  const auto open = [&](const tree::WideTree::Node& node) HWY_ATTR {
    for (uint32_t met = boxes_met(node, ray, enter); met != 0; met &= met - 1) {
      const uint32_t child = node.child[std::countr_zero(met)];
      if (!tree::WideTree::is_leaf(child)) {
        stack.push_back(child);
        continue;
      }
      const sites::Regions& regions = sites.regions;
      const uint32_t leaf = tree::WideTree::leaf_number(child), first = regions.leaves[leaf];
      uint32_t faces =
          discs_met(regions.bounds[leaf], regions.leaves[leaf + 1] - first, ray) | regions.thin[leaf];
      for (; faces != 0; faces &= faces - 1)
        if (visit(regions.owners[first + static_cast<uint32_t>(std::countr_zero(faces))].face)) return false;
    }
    return true;
  };
  for (const tree::WideTree::Node& node : from)
    if (!open(node)) return;
  while (!stack.empty()) {
    const uint32_t index = stack.back();
    stack.pop_back();
    if (!open(sites.wide.nodes[index])) return;
  }
}

void VisitFacesOnSegment(const sites::SitesData& sites, const Segment& segment, const NearNodes* near,
                         const FaceVisitor& visitor, Scratch& scratch) {
  UnitRay unit;
  const Vec3 &p = segment.p, &q = segment.q;
  const Ray ray{.origin = p,
                .direction = {q[0] - p[0], q[1] - p[1], q[2] - p[2]},
                .t_min = segment.first,
                .t_max = segment.last};
  if (!unit.place(ray, sites.frame)) return;
  const std::span<const tree::WideTree::Node> from =
      near ? std::span(near->nodes) : std::span(sites.wide.nodes).first(1);
  for_each_face_below(sites, from, unit, scratch.nodes,
                      [&](uint32_t face) { return visitor.visit(visitor.data, face); });
}

// The children of a node whose boxes meet the box.
HWY_INLINE uint32_t boxes_meeting(const tree::WideTree::Node& node, const tree::FloatBox& box) {
  return select(node.count, [&](size_t i) HWY_ATTR {
    const Block d;
    auto meet = hn::FirstN(d, kWidth);
    for (int k = 0; k < 3; ++k)
      meet = hn::And(meet, hn::And(hn::Le(hn::Load(d, node.lower[k] + i), hn::Set(d, box.upper[k])),
                                   hn::Ge(hn::Load(d, node.upper[k] + i), hn::Set(d, box.lower[k]))));
    return meet;
  });
}

void FindNearNodes(const sites::SitesData& sites, const tree::FloatBox& box, NearNodes& near) {
  constexpr size_t kFew = 8;  // nodes of eight
  near.nodes.assign(1, sites.wide.nodes[0]);
  for (;;) {
    near.next.clear();
    bool lower = false;
    const auto add = [&](const tree::WideTree::Node& node, uint32_t i) {
      if (near.next.empty() || near.next.back().count == kWidth) near.next.emplace_back();
      tree::WideTree::Node& to = near.next.back();
      const uint32_t at = to.count++;
      for (int k = 0; k < 3; ++k) {
        to.lower[k][at] = node.lower[k][i];
        to.upper[k][at] = node.upper[k][i];
      }
      to.child[at] = node.child[i];
    };
    for (const tree::WideTree::Node& node : near.nodes) {
      for (uint32_t meet = boxes_meeting(node, box); meet != 0; meet &= meet - 1) {
        const auto i = static_cast<uint32_t>(std::countr_zero(meet));
        if (tree::WideTree::is_leaf(node.child[i])) {
          add(node, i);
          continue;
        }
        lower = true;
        const tree::WideTree::Node& below = sites.wide.nodes[node.child[i]];
        for (uint32_t bits = boxes_meeting(below, box); bits != 0; bits &= bits - 1)
          add(below, static_cast<uint32_t>(std::countr_zero(bits)));
      }
      if (near.next.size() > kFew) return;
    }
    std::swap(near.nodes, near.next);
    if (!lower) return;
  }
}

void Occluded(const sites::SitesData& sites, std::span<const Ray> rays, Scratch& scratch, uint8_t* result) {
  for (size_t i = 0; i < rays.size(); ++i) {
    result[i] = 0;
    UnitRay unit;
    if (!unit.place(rays[i], sites.frame)) continue;
    for_each_face(sites, unit, scratch, [&](uint32_t face) HWY_ATTR {
      result[i] = meet(sites, rays[i], face) < kInfinity;
      return result[i] != 0;
    });
  }
}

}  // namespace sdm::rays::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::rays {

HWY_EXPORT(FirstHits);
HWY_EXPORT(FirstHitsAmong);
HWY_EXPORT(VisitFacesOnSegment);
HWY_EXPORT(FindNearNodes);
HWY_EXPORT(Occluded);

void first_hits(const sites::SitesData& sites, std::span<const Ray> rays, Scratch& scratch, RayHit* hits) {
  HWY_DYNAMIC_DISPATCH(FirstHits)(sites, rays, scratch, hits);
}
void first_hits(const sites::SitesData& sites, std::span<const Ray> rays, const FaceFilter& filter,
                Scratch& scratch, RayHit* hits) {
  HWY_DYNAMIC_DISPATCH(FirstHitsAmong)(sites, rays, filter, scratch, hits);
}
void find_near_nodes(const sites::SitesData& sites, const tree::FloatBox& box, NearNodes& near) {
  HWY_DYNAMIC_DISPATCH(FindNearNodes)(sites, box, near);
}
void visit_faces_on_segment(const sites::SitesData& sites, const Segment& segment, const NearNodes* near,
                            const FaceVisitor& visitor, Scratch& scratch) {
  HWY_DYNAMIC_DISPATCH(VisitFacesOnSegment)(sites, segment, near, visitor, scratch);
}
void occluded(const sites::SitesData& sites, std::span<const Ray> rays, Scratch& scratch,
              std::uint8_t* result) {
  HWY_DYNAMIC_DISPATCH(Occluded)(sites, rays, scratch, result);
}

}  // namespace sdm::rays
#endif
