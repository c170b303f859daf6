#include "rays/parallel_rays.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rays/parallel_rays.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "closest/facing/facing_normals.h"
#include "core/parallel.h"
#include "geometry/line_triangle.h"
#include "geometry/triangle.h"
#include "geometry/unit_across.h"
#include "geometry/vec.h"
#include "rays/unit_ray.h"

#ifndef SDM_PARALLEL_RAYS_ONCE
#define SDM_PARALLEL_RAYS_ONCE
namespace sdm::rays {
namespace {

// Decided in double precision, and exactly where that does not suffice.
bool meets(const sites::SitesData& sites, const Vec3& origin, const Vec3& direction, double max_distance,
           std::uint32_t face) {
  const auto hit = line_meets_triangle(origin, direction, corners_of(sites.mesh, face));
  return hit && hit->last >= 0 && hit->first <= max_distance;
}

}  // namespace
}  // namespace sdm::rays
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::rays::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kWidth = LeafCorners::Leaf::kWidth;
using Faces = hn::CappedTag<float, kWidth>;
using Lanes = hn::CappedTag<float, 16>;
using FaceVec = hn::Vec<Faces>;
using LaneVec = hn::Vec<Lanes>;

template <class D, class Mask>
HWY_INLINE uint32_t bits_of(D d, Mask mask) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0] | static_cast<uint32_t>(bytes[1]) << 8;
}

// Coordinates along two directions across the rays, u and v, and along them, w; from the centre of the
// origins.
struct Axes {
  float to[3][3];
};

// Origins are tested in groups, those of one near each other.
constexpr size_t kGroup = 16, kGroups = RayOrigins::kMost / kGroup;
using Groups = hn::CappedTag<float, kGroups>;

// The origins in these coordinates, and the boxes of all and of groups, of which those along the rays have no
// end.
struct Placed {
  alignas(64) float at[3][RayOrigins::kMost];
  alignas(16) float lower_of[3][kGroups], upper_of[2][kGroups];
  float lower[3], upper[3];
  float radius;  // of u, v and w
};

HWY_INLINE void place_origins(const RayOrigins& origins, const Axes& axes, Placed& placed) {
  const Lanes d;
  placed.radius = 0;
  for (int a = 0; a < 3; ++a) {
    placed.lower[a] = kInfinity;
    placed.upper[a] = -kInfinity;
  }
  for (size_t group = 0; group < kGroups; ++group) {
    LaneVec lower[3], upper[3];
    for (size_t lane = 0; lane < kGroup; lane += hn::Lanes(d)) {
      const size_t i = kGroup * group + lane;
      LaneVec q[3];
      for (int k = 0; k < 3; ++k) q[k] = hn::Load(d, origins.at[k] + i);
      for (int a = 0; a < 3; ++a) {
        LaneVec sum = hn::Mul(q[0], hn::Set(d, axes.to[a][0]));
        for (int k = 1; k < 3; ++k) sum = hn::MulAdd(q[k], hn::Set(d, axes.to[a][k]), sum);
        hn::Store(sum, d, placed.at[a] + i);
        lower[a] = lane == 0 ? sum : hn::Min(lower[a], sum);
        upper[a] = lane == 0 ? sum : hn::Max(upper[a], sum);
      }
    }
    for (int a = 0; a < 3; ++a) {
      const float least = hn::GetLane(hn::MinOfLanes(d, lower[a])),
                  most = hn::GetLane(hn::MaxOfLanes(d, upper[a]));
      placed.lower_of[a][group] = least;
      if (a < 2) placed.upper_of[a][group] = most;
      placed.lower[a] = std::min(placed.lower[a], least);
      placed.upper[a] = std::max(placed.upper[a], most);
      placed.radius = std::max({placed.radius, -least, most});
    }
  }
}

// A node's children whose boxes the rays may meet: see boxes_met() of rays/trace.cpp. The box of the origins
// enlarges boxes as the error of a ray does. Of the two sides across an axis, the direction says which is met
// first.
struct Shaft {
  UnitRay ray;
  bool forwards[3];

  HWY_INLINE uint32_t meets(const tree::WideTree::Node& node) const {
    const Faces d;
    uint32_t bits = 0;
    for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
      FaceVec first = hn::Set(d, ray.begin), last = hn::Set(d, ray.end);
      for (int k = 0; k < 3; ++k) {
        const FaceVec inverse = hn::Set(d, ray.inverse[k]);
        const FaceVec lower = hn::Sub(hn::Load(d, node.lower[k] + i), hn::Set(d, ray.beyond_lo[k]));
        const FaceVec upper = hn::Sub(hn::Load(d, node.upper[k] + i), hn::Set(d, ray.before_hi[k]));
        first = hn::Max(first, hn::Mul(forwards[k] ? lower : upper, inverse));
        last = hn::Min(last, hn::Mul(forwards[k] ? upper : lower, inverse));
      }
      bits |= bits_of(d, hn::Le(first, hn::Mul(last, hn::Set(d, 1 + 0x1p-20f)))) << i;
    }
    return bits & ((1u << node.count) - 1);
  }
};

// The faces of a leaf in the coordinates of the rays, with bounds on errors of rounding.
//
// A coordinate has an error of δ = 2⁻²⁴ (1 + 10 D) at most, where D is the largest coordinate of the corners
// and the origins: 2⁻²⁵ √3 from corners that are rounded in the unit frame; below 5 · 2⁻²⁴ |q|, |q| ≤ √3 D,
// from the difference, from rounded axes, and from the sum of three products. The products
//   e = a_u b_v − a_v b_u
// of corners a and b as seen from an origin have then, with |a|, |b| ≤ L in u and v, errors of at most
//   8 δ L + 8 δ² + 2⁻²² L² < 10 δ (L + δ) = ε,
// and with |c| ≤ M in w, Σ e c has one below 4 ε (L + M + δ), as |e| ≤ 2 L².
struct PlacedFaces {
  alignas(32) float at[3][3][kWidth];
  alignas(32) float lower[2][kWidth], upper[3][kWidth];  // of their boxes, enlarged by errors
  alignas(32) float error[kWidth], sum_error[kWidth];
};

// The faces of a leaf that are not certainly left by rays.
HWY_INLINE uint32_t faces_entered(const LeafCorners::Leaf& leaf, const Axes& axes) {
  const Faces d;
  uint32_t bits = 0;
  for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
    FaceVec cosine = hn::Zero(d);
    for (int k = 0; k < 3; ++k)
      cosine = hn::MulAdd(hn::Load(d, leaf.normal[k] + i), hn::Set(d, axes.to[2][k]), cosine);
    bits |= bits_of(d, hn::Lt(cosine, hn::Set(d, 1e-5f))) << i;
  }
  return bits;
}

// Returns the faces whose boxes the rays meet.
HWY_INLINE uint32_t place_faces(const LeafCorners::Leaf& leaf, const RayOrigins& origins, const Axes& axes,
                                const Placed& from, float end, PlacedFaces& placed) {
  const Faces d;
  uint32_t bits = 0;
  for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
    FaceVec lower[3], upper[3];
    for (int corner = 0; corner < 3; ++corner) {
      FaceVec q[3];
      for (int k = 0; k < 3; ++k)
        q[k] = hn::Sub(hn::Load(d, leaf.at[corner][k] + i), hn::Set(d, origins.centre[k]));
      for (int a = 0; a < 3; ++a) {
        FaceVec sum = hn::Mul(q[0], hn::Set(d, axes.to[a][0]));
        for (int k = 1; k < 3; ++k) sum = hn::MulAdd(q[k], hn::Set(d, axes.to[a][k]), sum);
        hn::Store(sum, d, placed.at[corner][a] + i);
        lower[a] = corner == 0 ? sum : hn::Min(lower[a], sum);
        upper[a] = corner == 0 ? sum : hn::Max(upper[a], sum);
      }
    }
    const FaceVec radius = hn::Set(d, from.radius);
    FaceVec largest[3];
    for (int a = 0; a < 3; ++a) largest[a] = hn::Add(hn::Max(hn::Neg(lower[a]), upper[a]), radius);
    const FaceVec across = hn::Max(largest[0], largest[1]), along = largest[2];
    const FaceVec coordinate_error =
        hn::MulAdd(hn::Max(across, along), hn::Set(d, 10 * 0x1p-24f), hn::Set(d, 0x1p-24f));
    const FaceVec error =
        hn::Mul(hn::Mul(coordinate_error, hn::Set(d, 10.f)), hn::Add(across, coordinate_error));
    hn::Store(error, d, placed.error + i);
    hn::Store(hn::Mul(hn::Mul(error, hn::Set(d, 4.f)), hn::Add(hn::Add(across, along), coordinate_error)), d,
              placed.sum_error + i);
    const FaceVec slack = hn::Add(coordinate_error, coordinate_error);
    auto met = hn::Le(hn::Sub(lower[2], slack), hn::Set(d, from.upper[2] + end));
    for (int a = 0; a < 3; ++a) {
      const FaceVec most = hn::Add(upper[a], slack);
      hn::Store(most, d, placed.upper[a] + i);
      met = hn::And(met, hn::Ge(most, hn::Set(d, from.lower[a])));
      if (a == 2) continue;
      const FaceVec least = hn::Sub(lower[a], slack);
      hn::Store(least, d, placed.lower[a] + i);
      met = hn::And(met, hn::Le(least, hn::Set(d, from.upper[a])));
    }
    bits |= bits_of(d, met) << i;
  }
  return bits & ((1u << leaf.count) - 1);
}

// The groups of origins whose boxes' rays meet that of a face.
HWY_INLINE uint32_t groups_met(const Placed& from, const PlacedFaces& faces, int face) {
  const Groups d;
  uint32_t bits = 0;
  for (size_t i = 0; i < kGroups; i += hn::Lanes(d)) {
    auto met = hn::Le(hn::Load(d, from.lower_of[2] + i), hn::Set(d, faces.upper[2][face]));
    for (int a = 0; a < 2; ++a) {
      met = hn::And(met, hn::Le(hn::Load(d, from.lower_of[a] + i), hn::Set(d, faces.upper[a][face])));
      met = hn::And(met, hn::Ge(hn::Load(d, from.upper_of[a] + i), hn::Set(d, faces.lower[a][face])));
    }
    bits |= bits_of(d, met) << i;
  }
  return bits;
}

// Lanes whose rays certainly meet a face, and those for which rounding may decide; whether the former leave
// it, by the order of its corners.
struct Met {
  uint32_t certain, uncertain, leaving;
};

// The line of a ray meets the face abc if the three products e of its edges have one sign, at (Σ e c) / Σ e
// from the origin with c the opposite corners' w, of which only the sign matters unless rays end.
HWY_INLINE Met lanes_met(const Placed& from, const RayOrigins& origins, size_t lane, const PlacedFaces& faces,
                         int face, uint32_t number, bool ends, float end) {
  const Lanes d;
  LaneVec q[3][3];
  for (int corner = 0; corner < 3; ++corner)
    for (int a = 0; a < 3; ++a)
      q[corner][a] = hn::Sub(hn::Set(d, faces.at[corner][a][face]), hn::Load(d, from.at[a] + lane));
  LaneVec e[3];
  for (int k = 0; k < 3; ++k) {
    const auto &a = q[(k + 1) % 3], &b = q[(k + 2) % 3];
    e[k] = hn::MulSub(a[0], b[1], hn::Mul(a[1], b[0]));
  }
  const LaneVec least = hn::Min(hn::Min(e[0], e[1]), e[2]), most = hn::Max(hn::Max(e[0], e[1]), e[2]);
  const LaneVec error = hn::Set(d, faces.error[face]), below = hn::Neg(error);
  const auto missed = hn::And(hn::Lt(least, below), hn::Gt(most, error));
  const auto left = hn::Gt(least, error), right = hn::Lt(most, below);
  const LaneVec sum = hn::MulAdd(e[0], q[0][2], hn::MulAdd(e[1], q[1][2], hn::Mul(e[2], q[2][2])));
  const LaneVec sum_error = hn::Set(d, faces.sum_error[face]);
  // The sum with the sign of Σ e.
  const LaneVec signed_sum = hn::IfThenElse(right, hn::Neg(sum), sum);
  const auto within = hn::Or(left, right);
  auto behind = hn::And(within, hn::Lt(signed_sum, hn::Neg(sum_error)));
  auto ahead = hn::And(within, hn::Gt(signed_sum, sum_error));
  if (ends) {
    const LaneVec last = hn::Mul(hn::Set(d, end), hn::Abs(hn::Add(hn::Add(e[0], e[1]), e[2])));
    const LaneVec last_error = hn::MulAdd(hn::Set(d, 4 * end), error, sum_error);
    behind = hn::Or(behind, hn::And(within, hn::Gt(hn::Sub(signed_sum, last), last_error)));
    ahead = hn::And(ahead, hn::Lt(hn::Sub(signed_sum, last), hn::Neg(last_error)));
  }
  const hn::RebindToUnsigned<Lanes> du;
  const auto own = hn::RebindMask(d, hn::Eq(hn::Load(du, origins.own + lane), hn::Set(du, number)));
  const auto none = hn::Or(hn::Or(missed, behind), own);
  const uint32_t certain = bits_of(d, hn::AndNot(own, ahead));
  return {certain, ~(bits_of(d, none) | certain), bits_of(d, left)};
}

// Rays of one direction on their way through the tree.
class Search {
 public:
  Search(const LeafCorners& faces, const RayOrigins& origins, const Vec3& direction, double max_distance)
      : faces_(faces), origins_(origins), direction_(direction), max_distance_(max_distance) {
    const UnitFrame& frame = faces.sites.frame;
    Vec3 middle;
    for (int k = 0; k < 3; ++k) middle[k] = origins.centre[k] / frame.scale + frame.origin[k];
    meets_ = !faces.sites.wide.nodes.empty() && shaft_.ray.place({middle, direction, 0, max_distance}, frame);
    if (!meets_) return;
    const Vec3 u = unit_across(direction), v = cross(direction, u);
    for (int k = 0; k < 3; ++k) {
      shaft_.ray.beyond_lo[k] += origins.half[k];
      shaft_.ray.before_hi[k] -= origins.half[k];
      shaft_.forwards[k] = shaft_.ray.inverse[k] > 0;
      axes_.to[0][k] = static_cast<float>(u[k]);
      axes_.to[1][k] = static_cast<float>(v[k]);
      axes_.to[2][k] = static_cast<float>(direction[k]);
    }
    place_origins(origins, axes_, from_);
    end_ = static_cast<float>(std::min(max_distance * frame.scale, kReach));
  }

  // Calls visit(leaf) for the leaves that rays may meet, until it returns true.
  template <class Visit>
  HWY_INLINE void for_each_leaf(std::vector<uint32_t>& stack, const Visit& visit) const {
    if (!meets_) return;
    const tree::WideTree& tree = faces_.sites.wide;
    stack.assign(1, 0);
    while (!stack.empty()) {
      const tree::WideTree::Node& node = tree.nodes[stack.back()];
      stack.pop_back();
      for (uint32_t met = shaft_.meets(node); met != 0; met &= met - 1) {
        const uint32_t child = node.child[std::countr_zero(met)];
        if (!tree::WideTree::is_leaf(child))
          stack.push_back(child);
        else if (visit(faces_.leaves[tree::WideTree::leaf_number(child)]))
          return;
      }
    }
  }

  // Calls visit(face, first lane, Met) for the faces of a leaf, those of `which`, and lanes of `active`.
  template <class Visit>
  HWY_INLINE void for_each_face(const LeafCorners::Leaf& leaf, uint32_t which, const uint64_t& active,
                                const Visit& visit) const {
    const Lanes d;
    const uint32_t all = hn::Lanes(d) == 32 ? ~0u : (1u << hn::Lanes(d)) - 1;
    PlacedFaces placed;
    for (uint32_t left = place_faces(leaf, origins_, axes_, from_, end_, placed) & which; left != 0;
         left &= left - 1) {
      const int face = std::countr_zero(left);
      for (uint32_t groups = groups_met(from_, placed, face); groups != 0; groups &= groups - 1) {
        const size_t group = kGroup * static_cast<size_t>(std::countr_zero(groups));
        for (size_t lane = group; lane < group + kGroup; lane += hn::Lanes(d)) {
          const auto wanted = static_cast<uint32_t>(active >> lane) & all;
          if (wanted == 0) continue;
          Met met = lanes_met(from_, origins_, lane, placed, face, leaf.face[face], end_ < kReach, end_);
          met.certain &= wanted;
          met.uncertain &= wanted;
          visit(leaf.face[face], lane, met);
        }
      }
      if (active == 0) return;
    }
  }

  // The lanes of `active` that meet a face; of rays that only `enter`, faces that they leave count as none.
  HWY_INLINE uint64_t occluded(uint64_t active, bool enter, std::vector<uint32_t>& stack) const {
    uint64_t result = 0;
    for_each_leaf(stack, [&](const LeafCorners::Leaf& leaf) HWY_ATTR {
      const uint32_t which = enter ? faces_entered(leaf, axes_) : ~0u;
      if (which == 0) return false;
      for_each_face(leaf, which, active, [&](uint32_t face, size_t lane, const Met& met) HWY_ATTR {
        const uint64_t hits = met.certain | exactly_met(met.uncertain, face, lane);
        result |= hits << lane;
        active &= ~(hits << lane);
      });
      return active == 0;
    });
    return result;
  }

  // The lanes of `active` that leave as many faces as they enter, unless rounding may decide about one.
  HWY_INLINE uint64_t outside(uint64_t active, std::vector<uint32_t>& stack) const {
    int32_t windings[RayOrigins::kMost] = {};
    for_each_leaf(stack, [&](const LeafCorners::Leaf& leaf) HWY_ATTR {
      for_each_face(leaf, ~0u, active, [&](uint32_t face, size_t lane, const Met& met) HWY_ATTR {
        active &= ~(uint64_t{exactly_met(met.uncertain, face, lane)} << lane);
        for (uint32_t hits = met.certain; hits != 0; hits &= hits - 1) {
          const int i = std::countr_zero(hits);
          const bool leaves = (met.leaving >> i & 1) != 0;
          windings[lane + static_cast<size_t>(i)] += leaves == (faces_.sites.inverted[face] == 0) ? 1 : -1;
        }
      });
      return active == 0;
    });
    for (size_t i = 0; i < origins_.count; ++i)
      if (windings[i] != 0) active &= ~(uint64_t{1} << i);
    return active;
  }

 private:
  // Those of some lanes that meet the face.
  HWY_INLINE uint32_t exactly_met(uint32_t lanes, uint32_t face, size_t first) const {
    uint32_t result = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
      const int i = std::countr_zero(lanes);
      const Vec3& origin = origins_.point[first + static_cast<size_t>(i)];
      if (meets(faces_.sites, origin, direction_, max_distance_, face)) result |= 1u << i;
    }
    return result;
  }

  static constexpr double kReach = 8;  // of a ray in the unit frame

  const LeafCorners& faces_;
  const RayOrigins& origins_;
  const Vec3& direction_;
  const double max_distance_;
  bool meets_;
  Shaft shaft_;
  Axes axes_;
  Placed from_;
  float end_;
};

uint64_t Occluded(const LeafCorners& faces, const RayOrigins& origins, const Vec3& direction,
                  double max_distance, uint64_t active, std::vector<uint32_t>& stack) {
  if (active == 0) return 0;
  const Search search(faces, origins, direction, max_distance);
  // Rays that end may do so between a face that they leave and one through which they entered.
  const uint64_t outside = max_distance < kInfinity ? 0 : active & origins.outside;
  uint64_t result = 0;
  if (outside != 0) result |= search.occluded(outside, true, stack);
  if (outside != active) result |= search.occluded(active & ~outside, false, stack);
  return result;
}

uint64_t Outside(const LeafCorners& faces, const RayOrigins& origins, const Vec3& direction, uint64_t active,
                 std::vector<uint32_t>& stack) {
  return Search(faces, origins, direction, kInfinity).outside(active, stack);
}

}  // namespace sdm::rays::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::rays {

HWY_EXPORT(Occluded);
HWY_EXPORT(Outside);

void find_outside(const LeafCorners& faces, RayOrigins& origins, const Vec3& direction, std::uint64_t active,
                  std::vector<std::uint32_t>& stack) {
  if (active != 0 && faces.sites.is_solid())
    origins.outside |= HWY_DYNAMIC_DISPATCH(Outside)(faces, origins, direction, active, stack);
}

std::uint64_t occluded(const LeafCorners& faces, const RayOrigins& origins, const Vec3& direction,
                       double max_distance, std::uint64_t active, std::vector<std::uint32_t>& stack) {
  return HWY_DYNAMIC_DISPATCH(Occluded)(faces, origins, direction, max_distance, active, stack);
}

LeafCorners::LeafCorners(const sites::SitesData& s) : sites(s) {
  const sites::Regions& regions = sites.regions;
  leaves.resize(regions.leaves.empty() ? 0 : regions.leaves.size() - 1);
  parallel_for(leaves.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Leaf& leaf = leaves[i];
      const std::uint32_t first = regions.leaves[i];
      leaf.count = regions.leaves[i + 1] - first;
      for (std::uint32_t f = 0; f < Leaf::kWidth; ++f) {
        leaf.face[f] = regions.owners[first + std::min(f, leaf.count - 1)].face;
        const auto corners = corners_of(sites.mesh, leaf.face[f]);
        for (int corner = 0; corner < 3; ++corner) {
          const Vec3 p = sites.frame.to_unit(corners[corner]);
          for (int k = 0; k < 3; ++k) leaf.at[corner][k][f] = static_cast<float>(p[k]);
        }
        const bool reliable = sites.is_solid() && sites.sliver[leaf.face[f]] == 0;
        const Vec3 normal = reliable ? facing::outward_normal(sites, leaf.face[f]) : Vec3{};
        for (int k = 0; k < 3; ++k) leaf.normal[k][f] = static_cast<float>(normal[k]);
      }
    }
  });
}

void RayOrigins::place(const UnitFrame& frame) {
  outside = 0;
  Box box;
  for (std::size_t i = 0; i < count; ++i) extend(box, frame.to_unit(point[i]));
  for (int k = 0; k < 3; ++k) {
    centre[k] = static_cast<float>(0.5 * (box.lower[k] + box.upper[k]));
    const double farther = std::max(box.upper[k] - centre[k], centre[k] - box.lower[k]);
    half[k] = static_cast<float>(1.000001 * farther);
  }
  for (std::size_t i = 0; i < kMost; ++i) {
    const std::size_t from = std::min(i, count - 1);
    const Vec3 p = frame.to_unit(point[from]);
    for (int k = 0; k < 3; ++k) at[k][i] = static_cast<float>(p[k] - centre[k]);
    own[i] = face[from];
  }
}

}  // namespace sdm::rays
#endif
