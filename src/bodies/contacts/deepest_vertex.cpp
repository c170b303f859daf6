#include "bodies/contacts/deepest_vertex.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bodies/contacts/deepest_vertex.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "geometry/lanes/point_triangle-inl.h"
#include "geometry/rounding.h"
#include "geometry/triangle.h"
#include "sites/closest_on_face.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::contacts::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace lanes::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, DeepestVertex::kLanes>;
using Vec = hn::Vec<Lanes>;

// Lowers the bounds of vertices to their distances from a triangle, or from its sides if it has no reliable
// normal.
void BoundByTriangle(const DeepestVertex::UnitTriangle& t, DeepestVertex::Rows rows, size_t first,
                     size_t last) {
  const Lanes d;
  const TriangleSides<Lanes> sides(splat(d, t.corner[0]), splat(d, t.corner[1]), splat(d, t.corner[2]));
  const auto flat = hn::FirstN(d, t.flat ? kLanes : 0);
  for (size_t i = first; i < last; i += hn::Lanes(d)) {
    const Vec3Of<Vec> p{hn::LoadU(d, rows.at[0] + i), hn::LoadU(d, rows.at[1] + i),
                        hn::LoadU(d, rows.at[2] + i)};
    const Vec distance = hn::Sqrt(sides.squared_distance(p, flat));
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
// Rounding of distances in single precision, relative to the coordinates.
constexpr float kUnitRounding = 4e-6f;

}  // namespace

void DeepestVertex::start(const shape::Body& on, const shape::Body& other, const mesh::Similarity& to_other,
                          const mesh::Similarity& from_other) {
  on_ = &on;
  other_ = &other;
  to_other_ = &to_other;
  const UnitFrame& frame = internals(on.sites()).frame;
  to_unit_ = {from_other.map, frame.scale * from_other.scale};
  for (std::size_t k = 0; k < 3; ++k) {
    for (double& x : to_unit_.map.rows[k]) x *= frame.scale;
    to_unit_.map.offset[k] = (to_unit_.map.offset[k] - frame.origin[k]) * frame.scale;
  }
  best_ = {};
  vertices_.clear();
  groups_.clear();
  faces_.clear();
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
  double largest = 1;
  const Corners corners = corners_of(sites.mesh, face);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 corner = to_unit_.map(corners[k]);
    for (std::size_t j = 0; j < 3; ++j) {
      t.corner[k][j] = static_cast<float>(corner[j]);
      largest = std::max(largest, std::abs(corner[j]));
    }
  }
  rounding_ = std::max(rounding_, kUnitRounding * static_cast<float>(largest));
  return t;
}

void DeepestVertex::bound(std::uint32_t face, std::size_t first, std::size_t last) {
  HWY_DYNAMIC_DISPATCH(BoundByTriangle)
  (unit_triangle(face), {{at_[0].data(), at_[1].data(), at_[2].data()}, bound_.data()}, first, last);
}

// The distance to the nearest one of the faces found and that of the group, probably the closest face of all.
double DeepestVertex::exact_bound(const Vec3& at, std::size_t i) const {
  const auto distance = [&](std::uint32_t face) {
    return sites::closest_on_face(internals(other_->sites()), face, at).distance;
  };
  const std::uint32_t group = std::prev(std::ranges::upper_bound(groups_, i, {}, &Group::first))->face;
  double bound = group == kNone ? kInfinity : distance(group);
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
    const double enough = -best_.point.distance * (1 + kDoubleRounding);
    if (largest == -kInfinity || largest + rounding_ <= enough * to_unit_.scale) break;
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
