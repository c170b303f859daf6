#include "bodies/contacts/faces_near_edge.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bodies/contacts/faces_near_edge.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "bodies/contacts/support.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::contacts::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kWidth = tree::WideTree::kWidth;
static_assert(kWidth == sites::FaceBounds::kWidth);
using Lanes = hn::CappedTag<float, kWidth>;
using Vec = hn::Vec<Lanes>;
using UnitSegment = FacesNearEdge::UnitSegment;
using Supporting = FacesNearEdge::Supporting;

constexpr float kSegmentRounding = FacesNearEdge::kSegmentRounding;
// A little more than the sine of the angles that can_push() allows for, between the plane of a face and the
// edge that it supports, and between the plane and what is beside the edge.
constexpr float kSupportSine = static_cast<float>(kPushSine) + 1e-3f;

HWY_INLINE void load(const float (&rows)[3][kWidth], size_t i, Vec (&v)[3]) {
  for (int k = 0; k < 3; ++k) v[k] = hn::Load(Lanes(), rows[k] + i);
}
HWY_INLINE Vec dot(const Vec (&a)[3], const Vec (&b)[3]) {
  return hn::MulAdd(a[2], b[2], hn::MulAdd(a[1], b[1], hn::Mul(a[0], b[0])));
}
HWY_INLINE void splat(const std::array<float, 3>& a, Vec (&v)[3]) {
  for (int k = 0; k < 3; ++k) v[k] = hn::Set(Lanes(), a[k]);
}
HWY_INLINE uint32_t bits(hn::Mask<Lanes> mask, size_t i) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(Lanes(), mask, bytes);
  return uint32_t{bytes[0]} << i;
}

// Boxes that a segment passes, enlarged by `max_distance`, and that are partly in all half-spaces added.
class Boxes {
 public:
  Boxes(const UnitSegment& segment, float max_distance) : segment_(segment) {
    const Lanes d;
    max_distance_ = hn::Set(d, max_distance + segment.rounding);
    for (int k = 0; k < 3; ++k) {
      constexpr float kLeast = 1e-12f;  // parallel to the sides of boxes
      const float along = segment.end[k] - segment.start[k];
      start_[k] = hn::Set(d, segment.start[k]);
      inverse_[k] = hn::Set(d, 1 / (std::abs(along) < kLeast ? kLeast : along));
    }
  }
  // A point of a face is above or below a point p of the segment, at p + h n, −margin ≤ h ≤ max_depth, and
  // the normal n of the face has a cosine of at least −s with `side`, and −s to s with the direction a of the
  // segment, s = kSupportSine. So it is in the half-space (x − p)·w ≥ −max(max_depth (1 + |side·a|) s,
  // margin), for w = side − (side·a) a, which is the same for all p.
  void add_half_space(const std::array<float, 3>& side, const Supporting& supporting) {
    const Lanes d;
    float cosine = 0, rest = 0, w[3];
    for (int k = 0; k < 3; ++k) cosine += side[k] * segment_.direction[k];
    for (int k = 0; k < 3; ++k) {
      w[k] = side[k] - cosine * segment_.direction[k];
      rest -= w[k] * segment_.start[k];
    }
    const float behind =
        std::max(supporting.max_depth * (1 + std::abs(cosine)) * kSupportSine, supporting.margin) +
        2 * segment_.rounding;
    HalfSpace& added = half_spaces_[count_++];
    for (int k = 0; k < 3; ++k) added.w[k] = hn::Set(d, w[k]);
    added.rest = hn::Set(d, rest + behind);
  }

  HWY_INLINE uint32_t passed(const tree::WideTree::Node& node) const {
    const Lanes d;
    uint32_t children = 0;
    for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
      Vec from = hn::Zero(d), to = hn::Set(d, 1.0f);
      for (int k = 0; k < 3; ++k) {
        const Vec lo =
            hn::Mul(hn::Sub(hn::Sub(hn::Load(d, node.lower[k] + i), max_distance_), start_[k]), inverse_[k]);
        const Vec hi =
            hn::Mul(hn::Sub(hn::Add(hn::Load(d, node.upper[k] + i), max_distance_), start_[k]), inverse_[k]);
        from = hn::Max(from, hn::Min(lo, hi));
        to = hn::Min(to, hn::Max(lo, hi));
      }
      auto open = hn::Le(from, to);
      for (int h = 0; h < count_; ++h) {
        Vec most = half_spaces_[h].rest;
        for (int k = 0; k < 3; ++k)
          most = hn::Add(most, hn::Max(hn::Mul(half_spaces_[h].w[k], hn::Load(d, node.lower[k] + i)),
                                       hn::Mul(half_spaces_[h].w[k], hn::Load(d, node.upper[k] + i))));
        open = hn::And(open, hn::Ge(most, hn::Zero(d)));
      }
      children |= bits(open, i);
    }
    return children & ((1u << node.count) - 1);
  }

 private:
  // x·w + rest ≥ 0
  struct HalfSpace {
    Vec w[3], rest;
  };

  const UnitSegment& segment_;
  Vec max_distance_, start_[3], inverse_[3];
  HalfSpace half_spaces_[2];
  int count_ = 0;
};

// The start of a segment above the planes of discs, the sines of the angles between them, and the middles of
// the discs as seen from the start.
struct Discs {
  Vec normal[3], to_centre[3], radius, height, sine, along;

  HWY_INLINE Discs(const sites::FaceBounds& bounds, size_t i, const UnitSegment& segment) {
    const Lanes d;
    Vec start[3], direction[3];
    load(bounds.normal, i, normal);
    load(bounds.centre, i, to_centre);
    splat(segment.start, start);
    splat(segment.direction, direction);
    for (int k = 0; k < 3; ++k) to_centre[k] = hn::Sub(to_centre[k], start[k]);
    radius = hn::Add(hn::Load(d, bounds.radius + i), hn::Set(d, segment.rounding));
    height = hn::Neg(dot(normal, to_centre));
    sine = dot(normal, direction);
    along = dot(to_centre, direction);
  }
};

// Faces whose discs are within `max_distance` of a segment.
class NearFaces {
 public:
  NearFaces(const UnitSegment& segment, float max_distance)
      : segment_(segment), max_distance_(max_distance + segment.rounding) {}
  // Both the plane and the ball of the disc are.
  HWY_INLINE uint32_t operator()(const sites::FaceBounds& bounds, size_t i) const {
    const Lanes d;
    const Discs discs(bounds, i, segment_);
    const Vec length = hn::Set(d, segment_.length), max_distance = hn::Set(d, max_distance_);
    const Vec end = hn::MulAdd(length, discs.sine, discs.height);
    const auto by_plane = hn::And(hn::Le(hn::Min(discs.height, end), max_distance),
                                  hn::Ge(hn::Max(discs.height, end), hn::Neg(max_distance)));
    const Vec squared = dot(discs.to_centre, discs.to_centre);
    const Vec aside =
        hn::NegMulAdd(discs.along, discs.along, hn::Mul(squared, hn::Set(d, 1 - kSegmentRounding)));
    const Vec beyond = hn::Sub(hn::Min(hn::Max(discs.along, hn::Zero(d)), length), discs.along);
    const Vec radius = hn::Add(discs.radius, max_distance);
    return bits(hn::And(by_plane, hn::Le(hn::MulAdd(beyond, beyond, aside), hn::Mul(radius, radius))), i);
  }

 private:
  const UnitSegment& segment_;
  float max_distance_;
};

// Faces that may support a segment.
class SupportingFaces {
 public:
  SupportingFaces(const UnitSegment& segment, const Supporting& supporting)
      : segment_(segment), supporting_(supporting) {}
  HWY_INLINE uint32_t operator()(const sites::FaceBounds& bounds, size_t i) const {
    const Lanes d;
    const Vec parallel = hn::Set(d, kSupportSine);
    const Discs discs(bounds, i, segment_);
    auto open = hn::Lt(hn::Abs(discs.sine), parallel);
    for (const std::array<float, 3>& direction : supporting_.sides) {
      Vec side[3];
      splat(direction, side);
      open = hn::And(open, hn::Gt(dot(discs.normal, side), hn::Neg(parallel)));
    }
    // Most faces are excluded by their normals.
    if (hn::AllFalse(d, open)) return 0;

    const Vec length = hn::Set(d, segment_.length);
    open = hn::And(open, hn::And(hn::Gt(discs.along, hn::Neg(discs.radius)),
                                 hn::Lt(discs.along, hn::Add(length, discs.radius))));
    // The height of the point of the segment that is closest to the middle of the disc, and how much it
    // varies within the radius of there.
    const Vec height = hn::MulAdd(discs.along, discs.sine, discs.height);
    const Vec rise = hn::MulAdd(parallel, discs.radius, hn::Set(d, segment_.rounding));
    open = hn::And(open, hn::And(hn::Lt(height, hn::Add(rise, hn::Set(d, supporting_.margin))),
                                 hn::Gt(hn::Add(height, rise), hn::Set(d, -supporting_.max_depth))));
    // How far the line is from the middle of the disc, across it in the plane of the disc.
    Vec direction[3], across[3];
    splat(segment_.direction, direction);
    for (int k = 0; k < 3; ++k) {
      const int m = (k + 1) % 3, n = (k + 2) % 3;
      across[k] = hn::MulSub(direction[m], discs.normal[n], hn::Mul(direction[n], discs.normal[m]));
    }
    return bits(hn::And(open, hn::Lt(hn::Abs(dot(across, discs.to_centre)), discs.radius)), i);
  }

 private:
  const UnitSegment& segment_;
  const Supporting& supporting_;
};

namespace {

// The policy of a search for the faces of which `faces` is true, in the boxes passed.
template <class Faces>
struct Collect {
  const sites::Regions& regions;
  const Boxes& boxes;
  const Faces& faces;
  std::vector<uint32_t>& found;

  bool enter(const tree::OpenNode&) const { return true; }
  uint32_t bound(const tree::OpenNode&, const tree::WideTree::Node& node) const { return boxes.passed(node); }
  void leaf(const tree::OpenNode& open) const {
    const uint32_t leaf = open.leaf_number(), first = regions.leaves[leaf];
    uint32_t near = regions.thin[leaf];  // their normals are unreliable
    for (size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) near |= faces(regions.bounds[leaf], i);
    near &= (1u << (regions.leaves[leaf + 1] - first)) - 1;
    for (; near != 0; near &= near - 1) found.push_back(regions.owners[first + std::countr_zero(near)].face);
  }
};
template <class Faces>
Collect(const sites::Regions&, const Boxes&, const Faces&, std::vector<uint32_t>&) -> Collect<Faces>;

}  // namespace

void CollectNear(const sites::SitesData& sites, const UnitSegment& segment, float max_distance,
                 std::vector<tree::OpenNode>& stack, std::vector<uint32_t>& found) {
  const Boxes boxes(segment, max_distance);
  const NearFaces faces(segment, max_distance);
  tree::visit(sites.wide, stack, Collect{sites.regions, boxes, faces, found});
}

void CollectSupporting(const sites::SitesData& sites, const UnitSegment& segment,
                       const Supporting& supporting, std::vector<tree::OpenNode>& stack,
                       std::vector<uint32_t>& found) {
  Boxes boxes(segment, std::max(supporting.margin, supporting.max_depth));
  for (const std::array<float, 3>& side : supporting.sides) boxes.add_half_space(side, supporting);
  const SupportingFaces faces(segment, supporting);
  tree::visit(sites.wide, stack, Collect{sites.regions, boxes, faces, found});
}

}  // namespace sdm::contacts::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::contacts {
namespace {

HWY_EXPORT(CollectNear);
HWY_EXPORT(CollectSupporting);

std::array<float, 3> to_float(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

// The part of a segment within `max_distance` of the box of the mesh, along its axes; nothing if there is
// none. Of a segment that is much longer than the mesh, single precision would say nothing about this part.
std::optional<FacesNearEdge::UnitSegment> to_unit(const sites::SitesData& sites,
                                                  const FacesNearEdge::Segment& segment,
                                                  double max_distance) {
  const UnitFrame& frame = sites.frame;
  const Vec3 a = frame.to_unit(segment.a), along = frame.to_unit(segment.b) - a;
  const tree::FloatBox& box = sites.tree.box(0);
  constexpr double kSegmentRounding = FacesNearEdge::kSegmentRounding;
  const double around = (1 + kSegmentRounding) * frame.scale * max_distance + kSegmentRounding;
  double from = 0, to = 1, most = 0;
  for (int k = 0; k < 3; ++k) {
    const double lo = box.lower[k] - around - a[k], hi = box.upper[k] + around - a[k];
    if (along[k] != 0) {
      from = std::max(from, std::min(lo / along[k], hi / along[k]));
      to = std::min(to, std::max(lo / along[k], hi / along[k]));
    } else if (lo > 0 || hi < 0) {
      return {};
    }
    most = std::max({most, std::abs(box.lower[k] - around), std::abs(box.upper[k] + around)});
  }
  if (!(from <= to)) return {};
  const Vec3 part = (to - from) * along;
  return FacesNearEdge::UnitSegment{.start = to_float(a + from * along),
                                    .end = to_float(a + to * along),
                                    .direction = to_float(normalized(along)),
                                    .length = static_cast<float>(norm(part)),
                                    .rounding = static_cast<float>(kSegmentRounding * std::max(1.0, most))};
}

}  // namespace

std::span<const std::uint32_t> FacesNearEdge::find(const sites::SitesData& sites, const Segment& segment,
                                                   double max_distance) {
  faces_.clear();
  if (const std::optional<UnitSegment> unit = to_unit(sites, segment, max_distance))
    HWY_DYNAMIC_DISPATCH(CollectNear)
  (sites, *unit, static_cast<float>(sites.frame.scale * max_distance), stack_, faces_);
  return faces_;
}

std::span<const std::uint32_t> FacesNearEdge::find_supporting(const sites::SitesData& sites,
                                                              const Segment& segment,
                                                              std::span<const Vec3> sides, double margin,
                                                              double max_distance) {
  faces_.clear();
  const std::optional<UnitSegment> unit = to_unit(sites, segment, std::max(margin, max_distance));
  if (!unit) return faces_;
  Supporting supporting{.margin = static_cast<float>(sites.frame.scale * margin),
                        .max_depth = static_cast<float>(sites.frame.scale * max_distance)};
  // An edge of more faces has further sides, which could only exclude more.
  const std::size_t count = std::min(sides.size(), supporting.sides.size());
  for (std::size_t i = 0; i < count; ++i) supporting.sides[i] = to_float(normalized(sides[i]));
  HWY_DYNAMIC_DISPATCH(CollectSupporting)(sites, *unit, supporting, stack_, faces_);
  return faces_;
}

}  // namespace sdm::contacts
#endif
