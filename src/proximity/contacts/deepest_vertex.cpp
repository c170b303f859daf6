#include "proximity/contacts/deepest_vertex.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "proximity/contacts/deepest_vertex.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "geometry/vec.h"
#include "sites/closest_on_face.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::contacts::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, DeepestVertex::kLanes>;
using Vec = hn::Vec<Lanes>;

HWY_INLINE Vec dot(const Vec (&a)[3], const float* b) {
  const Lanes d;
  return hn::MulAdd(a[2], hn::Set(d, b[2]),
                    hn::MulAdd(a[1], hn::Set(d, b[1]), hn::Mul(a[0], hn::Set(d, b[0]))));
}

// Lowers the bounds of vertices to their distances from a triangle, or from its sides if it has no reliable
// normal.
void BoundByTriangle(const DeepestVertex::UnitTriangle& t, DeepestVertex::Rows rows, size_t first,
                     size_t last) {
  const Lanes d;
  for (size_t i = first; i < last; i += hn::Lanes(d)) {
    Vec squared = hn::Inf(d), least = hn::Set(d, t.flat ? 1.0f : -1.0f), height = hn::Inf(d);
    for (int k = 0; k < 3; ++k) {
      Vec rest[3];
      for (int j = 0; j < 3; ++j) rest[j] = hn::Sub(hn::LoadU(d, rows.at[j] + i), hn::Set(d, t.corner[k][j]));
      if (k == 0) height = hn::Abs(dot(rest, t.normal));
      least = hn::Min(least, dot(rest, t.wall[k]));
      const Vec along = hn::Min(hn::Max(hn::Mul(dot(rest, t.side[k]), hn::Set(d, t.inverse[k])), hn::Zero(d)),
                                hn::Set(d, 1.0f));
      for (int j = 0; j < 3; ++j) rest[j] = hn::NegMulAdd(along, hn::Set(d, t.side[k][j]), rest[j]);
      squared = hn::Min(
          squared, hn::MulAdd(rest[2], rest[2], hn::MulAdd(rest[1], rest[1], hn::Mul(rest[0], rest[0]))));
    }
    const Vec distance = hn::IfThenElse(hn::Gt(least, hn::Zero(d)), height, hn::Sqrt(squared));
    hn::StoreU(hn::Min(hn::LoadU(d, rows.bound + i), distance), d, rows.bound + i);
  }
}

// The largest of the bounds, whose number is a multiple of the lanes.
float LargestBound(const float* bound, size_t count) {
  const Lanes d;
  Vec largest = hn::Set(d, -std::numeric_limits<float>::infinity());
  for (size_t i = 0; i < count; i += hn::Lanes(d)) largest = hn::Max(largest, hn::LoadU(d, bound + i));
  return hn::GetLane(hn::MaxOfLanes(d, largest));
}

}  // namespace sdm::contacts::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::contacts {
namespace {

HWY_EXPORT(BoundByTriangle);
HWY_EXPORT(LargestBound);

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Of distances in single precision, relative to the coordinates; of those of single faces, relative to
// themselves.
constexpr float kUnitRounding = 4e-6f;
constexpr double kRounding = 1e-12;
constexpr double kShortest = 1e-30;  // squared side that has an inverse in single precision

}  // namespace

void DeepestVertex::start(const shape::Body& on, const shape::Body& other, const mesh::Similarity& to_other,
                          const mesh::Similarity& from_other) {
  on_ = &on, other_ = &other, to_other_ = &to_other;
  const UnitFrame& frame = internals(on.sites()).frame;
  scale_ = frame.scale * from_other.scale;
  to_unit_ = from_other.map;
  for (std::size_t k = 0; k < 3; ++k) {
    for (double& x : to_unit_.rows[k]) x *= frame.scale;
    to_unit_.offset[k] = (to_unit_.offset[k] - frame.origin[k]) * frame.scale;
  }
  best_ = {};
  vertices_.clear(), groups_.clear(), faces_.clear();
  for (std::vector<float>& row : at_) row.clear();
}

void DeepestVertex::start_group(std::uint32_t face) {
  groups_.push_back({static_cast<std::uint32_t>(vertices_.size()), face});
}

void DeepestVertex::add(std::uint32_t first, std::uint32_t last) {
  const sites::Regions& regions = internals(on_->sites()).regions;
  const std::size_t before = vertices_.size(), after = before + (last - first);
  vertices_.resize(after);
  for (std::vector<float>& row : at_) row.resize(after);
  for (std::uint32_t vertex = first; vertex < last; ++vertex) {
    const std::size_t i = before + (vertex - first);
    vertices_[i] = vertex;
    for (std::size_t k = 0; k < 3; ++k) at_[k][i] = regions.points[vertex].point[k];
  }
}

void DeepestVertex::add(std::uint32_t vertex, const SurfacePoint& point) {
  consider(vertex, point);
}

void DeepestVertex::consider(std::uint32_t vertex, const SurfacePoint& point) {
  if (point.distance < best_.point.distance) best_ = {vertex, point};
  if (std::ranges::find(faces_, point.face) == faces_.end()) faces_.push_back(point.face);
}

DeepestVertex::UnitTriangle DeepestVertex::unit_triangle(std::uint32_t face) {
  const sites::SitesData& sites = internals(other_->sites());
  UnitTriangle t{.flat = sites.sliver[face] == 0};
  std::array<Vec3, 3> corner, side;
  for (std::size_t k = 0; k < 3; ++k)
    corner[k] = to_unit_(sites.mesh.positions[sites.mesh.triangles[face][k]]);
  for (std::size_t k = 0; k < 3; ++k) side[k] = corner[(k + 1) % 3] - corner[k];
  const Vec3 normal = normalized(cross(side[0], side[1]));
  double largest = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double squared = squared_norm(side[k]);
    // Of length 1, so that the products below are distances.
    const Vec3 wall = normalized(cross(normal, side[k]));
    t.inverse[k] = static_cast<float>(squared > kShortest ? 1 / squared : 0);  // 0: by the corner
    t.normal[k] = static_cast<float>(normal[k]);
    for (std::size_t j = 0; j < 3; ++j) {
      t.corner[k][j] = static_cast<float>(corner[k][j]);
      t.side[k][j] = static_cast<float>(side[k][j]);
      t.wall[k][j] = static_cast<float>(wall[j]);
      largest = std::max(largest, std::abs(corner[k][j]));
    }
  }
  rounding_ = std::max(rounding_, kUnitRounding * static_cast<float>(largest));
  return t;
}

void DeepestVertex::bound(std::uint32_t face, std::size_t first, std::size_t last) {
  HWY_DYNAMIC_DISPATCH(BoundByTriangle)
  (unit_triangle(face), {{at_[0].data(), at_[1].data(), at_[2].data()}, bound_.data()}, first, last);
}

// By the faces found and that of its group, of which one is probably the closest.
double DeepestVertex::exact_bound(const Vec3& at, std::size_t i) const {
  const auto distance = [&](std::uint32_t face) {
    return sites::closest_on_face(internals(other_->sites()), face, at).distance;
  };
  const std::uint32_t group = std::prev(std::ranges::upper_bound(groups_, i, {}, &Group::first))->face;
  double bound = group == kNone ? std::numeric_limits<double>::infinity() : distance(group);
  for (const std::uint32_t face : faces_) bound = std::min(bound, distance(face));
  return bound;
}

DeepestVertex::Found DeepestVertex::find(double margin) {
  const std::size_t count = vertices_.size();
  const std::size_t padded = (count + kLanes - 1) / kLanes * kLanes;
  // A group ends in the middle of a register.
  for (std::vector<float>& row : at_) row.resize(padded + kLanes);
  bound_.assign(padded + kLanes, -kInfinity);
  std::fill_n(bound_.begin(), count, kInfinity);
  rounding_ = 0;
  for (std::size_t i = 0; i < groups_.size(); ++i)
    if (groups_[i].face != kNone)
      bound(groups_[i].face, groups_[i].first, i + 1 < groups_.size() ? groups_[i + 1].first : count);
  const sites::SitesData& own = internals(on_->sites());
  std::size_t used = 0;
  while (true) {
    for (; used < faces_.size(); ++used) bound(faces_[used], 0, count);
    const float largest = HWY_DYNAMIC_DISPATCH(LargestBound)(bound_.data(), padded);
    const double enough = -best_.point.distance * (1 + kRounding);
    if (largest == -kInfinity || largest + rounding_ <= enough * scale_) break;
    const std::size_t deepest = std::ranges::find(bound_, largest) - bound_.begin();
    bound_[deepest] = -kInfinity;
    const std::uint32_t vertex = vertices_[deepest];
    const Vec3 at = to_other_->map(own.mesh.positions[own.regions.points[vertex].vertex]);
    if (const double bound = exact_bound(at, deepest); bound > enough)
      consider(vertex, measure(*other_, at, bound));
  }
  if (!(best_.point.distance <= margin)) return {};
  return best_;
}

}  // namespace sdm::contacts
#endif
