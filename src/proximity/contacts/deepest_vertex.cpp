#include "proximity/contacts/deepest_vertex.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "proximity/contacts/deepest_vertex.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "core/geometry/triangle_pair.h"
#include "core/geometry/vec.h"
#include "core/geometry/vec_lanes-inl.h"
#include "sites/closest_on_face.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::contacts::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace core::HWY_NAMESPACE;

// Lowers bounds to the distances of points from a triangle, or from its sides if it has no reliable normal.
void BoundByTriangle(const Corners& at, bool flat, const double* x, const double* y, const double* z,
                     size_t count, double* bound) {
  const Doubles d;
  Vec3 side[3];
  double inverse[3];
  for (int k = 0; k < 3; ++k) {
    side[k] = at[(k + 1) % 3] - at[k];
    const double squared = squared_norm(side[k]);
    inverse[k] = squared > 0 ? 1 / squared : 0;
  }
  const Vec3 normal = normalized(sdm::cross(side[0], side[1]));
  Vec3 wall[3];
  for (int k = 0; k < 3; ++k) wall[k] = sdm::cross(normal, side[k]);
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Vec3v point{hn::LoadU(d, x + i), hn::LoadU(d, y + i), hn::LoadU(d, z + i)};
    Vec squared = hn::Inf(d), least = hn::Set(d, flat ? 1.0 : -1.0);
    for (int k = 0; k < 3; ++k) {
      const Vec3v from = sub(point, splat(at[k])), along = splat(side[k]);
      const Vec t =
          hn::Min(hn::Max(hn::Mul(dot(from, along), hn::Set(d, inverse[k])), hn::Zero(d)), hn::Set(d, 1.0));
      const Vec3v rest = sub_mul(from, t, along);
      squared = hn::Min(squared, dot(rest, rest));
      least = hn::Min(least, dot(from, splat(wall[k])));
    }
    const Vec height = hn::Abs(dot(sub(point, splat(at[0])), splat(normal)));
    const Vec distance = hn::IfThenElse(hn::Gt(least, hn::Zero(d)), height, hn::Sqrt(squared));
    hn::StoreU(hn::Min(hn::LoadU(d, bound + i), distance), d, bound + i);
  }
}

}  // namespace sdm::contacts::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::contacts {
namespace {

HWY_EXPORT(BoundByTriangle);

constexpr double kRounding = 1e-12;  // of distances, relative to themselves

std::size_t in_whole_lanes(std::size_t count) {
  constexpr std::size_t kLanes = 8;
  return (count + kLanes - 1) / kLanes * kLanes;
}

}  // namespace

void DeepestVertex::start(const shape::Body& on, const shape::Body& other, const mesh::Similarity& to_other) {
  constexpr double kUnitRounding = 1e-6;
  on_ = &on, other_ = &other, to_other_ = &to_other;
  const UnitFrame& frame = internals(on.sites()).frame;
  const double unit = 1 / frame.scale;
  from_unit_ = to_other.map * Affine{{{{unit, 0, 0}, {0, unit, 0}, {0, 0, unit}}}, frame.origin};
  rounding_ = kUnitRounding * unit * to_other.scale;
  best_ = {};
  vertices_.clear(), faces_.clear();
  x_.clear(), y_.clear(), z_.clear();
}

// From the coordinates in single precision, which follow each other in memory.
void DeepestVertex::add(std::uint32_t vertex) {
  const auto& [x, y, z] = internals(on_->sites()).regions.points[vertex].point;
  const Vec3 at = from_unit_(Vec3{x, y, z});
  vertices_.push_back(vertex);
  x_.push_back(at[0]), y_.push_back(at[1]), z_.push_back(at[2]);
}

void DeepestVertex::add(std::uint32_t vertex, const SurfacePoint& point) {
  consider(vertex, point);
  bound_by(point.face);
}

void DeepestVertex::bound_by(std::uint32_t face) {
  if (std::ranges::find(faces_, face) == faces_.end()) faces_.push_back(face);
}

void DeepestVertex::consider(std::uint32_t vertex, const SurfacePoint& point) {
  if (point.distance < best_.point.distance) best_ = {vertex, point};
}

double DeepestVertex::exact_bound(const Vec3& at) const {
  double bound = std::numeric_limits<double>::infinity();
  for (const std::uint32_t face : faces_)
    bound = std::min(bound, sites::closest_on_face(internals(other_->sites()), face, at).distance);
  return bound;
}

DeepestVertex::Found DeepestVertex::find(double margin) {
  const sites::SitesData& sites = internals(other_->sites());
  std::size_t count = vertices_.size();
  for (std::vector<double>* row : {&x_, &y_, &z_}) row->resize(in_whole_lanes(count));
  bound_.assign(in_whole_lanes(count), std::numeric_limits<double>::infinity());
  std::size_t used = 0;
  while (count > 0) {
    for (; used < faces_.size(); ++used) {
      const auto& [a, b, c] = sites.mesh.triangles[faces_[used]];
      HWY_DYNAMIC_DISPATCH(BoundByTriangle)
      ({sites.mesh.positions[a], sites.mesh.positions[b], sites.mesh.positions[c]},
       sites.sliver[faces_[used]] == 0, x_.data(), y_.data(), z_.data(), count, bound_.data());
    }
    // Removes those that are not deeper, and takes the one that may be deepest.
    const double enough = -best_.point.distance * (1 + kRounding);
    std::size_t kept = 0, deepest = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (bound_[i] + rounding_ <= enough) continue;
      vertices_[kept] = vertices_[i];
      x_[kept] = x_[i], y_[kept] = y_[i], z_[kept] = z_[i], bound_[kept] = bound_[i];
      if (bound_[kept] > bound_[deepest]) deepest = kept;
      ++kept;
    }
    count = kept;
    if (count == 0) break;
    const std::uint32_t vertex = vertices_[deepest];
    const sites::SitesData& own = internals(on_->sites());
    const Vec3 at = to_other_->map(own.mesh.positions[own.regions.points[vertex].vertex]);
    if (const double bound = exact_bound(at); bound > enough) {
      const SurfacePoint point = measure(*other_, at, bound);
      consider(vertex, point);
      bound_by(point.face);
    }
    --count;
    vertices_[deepest] = vertices_[count];
    x_[deepest] = x_[count], y_[deepest] = y_[count], z_[deepest] = z_[count];
    bound_[deepest] = bound_[count];
  }
  if (!(best_.point.distance <= margin)) return {};
  return best_;
}

}  // namespace sdm::contacts
#endif
