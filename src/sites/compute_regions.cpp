#include "sites/compute_regions.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sites/compute_regions.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>
#include <numbers>

#include "geometry/lanes/vec-inl.h"
#include "geometry/rounding.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::sites::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace lanes::HWY_NAMESPACE;

// The walls of a face thinner than this, in the unit frame, would enclose nothing in single precision. Its
// edges represent it instead: no point of it is farther from them than half of this.
constexpr double kThin = 1e-6;
// Faces whose smallest height is below this fraction of their longest side have normals that consist of
// rounding errors.
constexpr double kSliver = 1e-9;

// Four numbers per lane, the lanes consecutive, in single precision.
struct FourLanes {
  alignas(64) float at[kLanes][4];

  HWY_INLINE void store(const Vec3v& v, Vec w, size_t i) {
    const hn::Rebind<float, Doubles> d;
    hn::StoreInterleaved4(hn::DemoteTo(d, v.x), hn::DemoteTo(d, v.y), hn::DemoteTo(d, v.z),
                          hn::DemoteTo(d, w), d, at[i]);
  }
  // The first of the numbers, as many as `to` has room for.
  template <size_t count>
  HWY_INLINE void get(size_t lane, float (&to)[count]) const {
    static_assert(count <= 4);
    std::memcpy(to, at[lane], sizeof to);
  }
};

HWY_INLINE void store(Vec v, float* to) {
  const hn::Rebind<float, Doubles> d;
  hn::Store(hn::DemoteTo(d, v), d, to);
}
HWY_INLINE void store(const Vec3v& v, float (&to)[3][kLanes], size_t i) {
  store(v.x, to[0] + i);
  store(v.y, to[1] + i);
  store(v.z, to[2] + i);
}

// Into the unit frame.
class ToUnit {
 public:
  explicit ToUnit(const UnitFrame& frame) : frame_(frame) {}

  HWY_INLINE Vec3v point(const Vec3v& p) const { return between(splat(frame_.origin), p); }
  // The vector from a to b. The scale is a power of two: the difference is as exact as the mesh.
  HWY_INLINE Vec3v between(const Vec3v& a, const Vec3v& b) const {
    return mul(hn::Set(Doubles(), frame_.scale), sub(b, a));
  }

 private:
  const UnitFrame& frame_;
};

// The angle with this cosine. Near 0 and π, rounding changes the angle by 2e-8; as a weight of a
// pseudonormal, this could change a sign only where the other faces leave it undecided to as many digits.
HWY_INLINE Vec angle_of(Vec cosine) {
  const Doubles d;
  return hn::Acos(d, hn::Min(hn::Max(cosine, hn::Set(d, -1.0)), hn::Set(d, 1.0)));
}

// The centre of the smallest circle around a triangle, from its corner 0, given its sides and their squared
// lengths: with q the squared length of the side across from a corner, and q′ and q″ the others, corners have
// weights q (q′ + q″ − q), or 0, 1, 1 where the angle at the first is obtuse.
HWY_INLINE Vec3v enclosing_centre(const Vec3v (&side)[3], const Vec (&squared)[3], Vec longest_squared) {
  const Doubles d;
  const Vec inverse = inverse_or_zero(longest_squared);
  Vec weight[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (int k = 0; k < 3; ++k) {
    const Vec across = hn::Mul(squared[(k + 1) % 3], inverse);
    const Vec others = hn::Mul(hn::Add(squared[k], squared[(k + 2) % 3]), inverse);
    weight[k] = hn::Mul(across, hn::Sub(others, across));
  }
  for (int k = 0; k < 3; ++k) {
    const auto obtuse = hn::Le(weight[k], hn::Zero(d));
    for (int j = 0; j < 3; ++j) weight[j] = hn::IfThenElse(obtuse, hn::Set(d, j == k ? 0.0 : 1.0), weight[j]);
  }
  const Vec total = hn::Add(hn::Add(weight[0], weight[1]), weight[2]);
  return mul(hn::Div(hn::Set(d, 1.0), total), sub_mul(mul(weight[1], side[0]), weight[2], side[2]));
}

// The largest squared distance from this centre, relative to corner 0, to a corner.
HWY_INLINE Vec squared_radius(const Vec3v& centre, const Vec3v (&side)[3]) {
  const Vec3v from[3] = {centre, sub(centre, side[0]), add(centre, side[2])};
  return hn::Max(hn::Max(dot(from[0], from[0]), dot(from[1], from[1])), dot(from[2], from[2]));
}

void ComputeLeaf(Regions& regions, const Placement& placement, std::span<FaceShape> shapes, size_t leaf) {
  const uint32_t first = regions.leaves[leaf], count = regions.leaves[leaf + 1] - first;
  Vec3Lanes corners[3], normals, angles;
  for (uint32_t lane = 0; lane < count; ++lane)
    for (int k = 0; k < 3; ++k)
      corners[k].set(lane, placement.vertices[regions.places.corners[first + lane][k]]);
  FaceBounds& bounds = regions.bounds[leaf];
  FourLanes plane, wall[3];
  alignas(64) double height[kLanes], proportion[kLanes];
  const Doubles d;
  const ToUnit unit(placement.frame);
  for (size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
    const Vec3v corner[3] = {corners[0].load(i), corners[1].load(i), corners[2].load(i)};
    const Vec3v side[3] = {unit.between(corner[0], corner[1]), unit.between(corner[1], corner[2]),
                           unit.between(corner[2], corner[0])};
    const Vec squared[3] = {dot(side[0], side[0]), dot(side[1], side[1]), dot(side[2], side[2])};
    const Vec longest_squared = hn::Max(hn::Max(squared[0], squared[1]), squared[2]);
    const Vec3v area = cross(side[0], side[1]);
    const Vec size = hn::Sqrt(dot(area, area));
    const Vec3v normal = mul(inverse_or_zero(size), area), start = unit.point(corner[0]);
    normals.store(normal, i);
    plane.store(normal, dot(normal, start), i);

    const Vec least_height = hn::Mul(size, inverse_or_zero(hn::Sqrt(longest_squared)));
    hn::Store(least_height, d, height + i);
    hn::Store(hn::Mul(size, inverse_or_zero(longest_squared)), d, proportion + i);
    const auto has_prism = hn::Gt(least_height, hn::Set(d, kThin));
    Vec inverse[3];
    for (int k = 0; k < 3; ++k) {
      inverse[k] = inverse_or_zero(hn::Sqrt(squared[k]));
      const Vec3v inward = mul(inverse[k], cross(normal, side[k]));
      // No prism: a wall whose inner side is empty.
      wall[k].store(inward, hn::IfThenElse(has_prism, dot(inward, unit.point(corner[k])), hn::Inf(d)), i);
    }

    // The third angle follows from the other two.
    const Vec a = angle_of(hn::Neg(hn::Mul(hn::Mul(inverse[0], inverse[2]), dot(side[0], side[2]))));
    const Vec b = angle_of(hn::Neg(hn::Mul(hn::Mul(inverse[1], inverse[0]), dot(side[1], side[0]))));
    angles.store({a, b, hn::Sub(hn::Sub(hn::Set(d, std::numbers::pi), a), b)}, i);

    const Vec3v centre = enclosing_centre(side, squared, longest_squared);
    store(add(start, centre), bounds.centre, i);
    store(normal, bounds.normal, i);
    store(hn::Mul(hn::Set(d, 1 + kSingleRounding), hn::Sqrt(squared_radius(centre, side))),
          bounds.radius + i);
  }
  for (uint32_t lane = 0; lane < count; ++lane) {
    FaceRegion& region = regions.faces[first + lane];
    plane.get(lane, region.plane);
    for (int k = 0; k < 3; ++k) wall[k].get(lane, region.wall[k]);
    FaceShape& shape = shapes[first + lane];
    const double sign = placement.inverted[regions.owners[first + lane].face] ? -1 : 1;
    for (int k = 0; k < 3; ++k) {
      shape.normal[k] = sign * normals.at[k][lane];
      shape.angle[k] = angles.at[k][lane];
    }
    shape.thin = !(height[lane] > kThin);
    shape.sliver = !(proportion[lane] > kSliver);
  }
}

void ComputeFaces(Regions& regions, const Placement& placement, std::span<FaceShape> shapes, size_t begin,
                  size_t end) {
  for (size_t leaf = begin; leaf < end; ++leaf) ComputeLeaf(regions, placement, shapes, leaf);
}

void ComputeEdges(Regions& regions, const Placement& placement, size_t begin, size_t end) {
  // Slightly above kThin, so that faces that are thin by their own measure are thin by this one, too.
  constexpr double kHardlyThicker = 1.000001 * kThin;
  const Doubles d;
  const ToUnit unit(placement.frame);
  for (size_t first = begin; first < end; first += kLanes) {
    const size_t count = std::min(kLanes, end - first);
    Vec3Lanes points[4];
    for (size_t lane = 0; lane < count; ++lane)
      for (int j = 0; j < 4; ++j)
        points[j].set(lane, placement.vertices[regions.places.edges[first + lane].corners[j]]);

    FourLanes starts, directions, wall[2];
    for (size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
      const Vec3v a = points[0].load(i), start = unit.point(a), along = unit.between(a, points[1].load(i));
      const Vec length = hn::Sqrt(dot(along, along));
      const Vec3v direction = mul(inverse_or_zero(length), along);
      starts.store(start, length, i);
      directions.store(direction, length, i);
      for (int j = 0; j < 2; ++j) {
        const Vec3v opposite = unit.between(a, points[2 + j].load(i));
        const Vec3v height = sub_mul(opposite, dot(opposite, direction), direction);
        const Vec size = hn::Sqrt(dot(height, height));
        const Vec3v third = sub(opposite, along);
        const Vec longest =
            hn::Sqrt(hn::Max(hn::Max(dot(along, along), dot(opposite, opposite)), dot(third, third)));
        // No wall towards a face that is represented by its edges.
        const auto thick = hn::Gt(hn::Mul(size, length), hn::Mul(hn::Set(d, kHardlyThicker), longest));
        const Vec3v inward = mul(hn::IfThenElseZero(thick, inverse_or_zero(size)), height);
        wall[j].store(inward, dot(inward, start), i);
      }
    }
    for (size_t lane = 0; lane < count; ++lane) {
      EdgeRegion& region = regions.edges[first + lane];
      starts.get(lane, region.start);
      directions.get(lane, region.direction);
      region.length = directions.at[lane][3];
      for (int j = 0; j < 2; ++j) wall[j].get(lane, region.wall[j]);
    }
  }
}

void ComputeVertices(Regions& regions, const Placement& placement, size_t begin, size_t end) {
  constexpr int kRays = VertexRegion::kRays;
  const Doubles d;
  const ToUnit unit(placement.frame);
  for (size_t first = begin; first < end; first += kLanes) {
    const size_t count = std::min(kLanes, end - first);
    Vec3Lanes points, ends[kRays];
    for (size_t lane = 0; lane < count; ++lane) {
      points.set(lane, placement.vertices[first + lane]);
      for (int k = 0; k < kRays; ++k)
        ends[k].set(lane, placement.vertices[regions.places.neighbours[first + lane][k]]);
    }
    FourLanes point, ray[kRays];
    for (size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
      const Vec3v p = points.load(i);
      point.store(unit.point(p), hn::Zero(d), i);
      for (int k = 0; k < kRays; ++k)
        ray[k].store(normalized(unit.between(p, ends[k].load(i))), hn::Zero(d), i);
    }
    for (size_t lane = 0; lane < count; ++lane) {
      VertexRegion& region = regions.vertices[first + lane];
      point.get(lane, region.point);
      point.get(lane, regions.points[first + lane].point);
      for (int k = 0; k < kRays; ++k) ray[k].get(lane, region.ray[k]);
    }
  }
}

}  // namespace sdm::sites::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::sites {

HWY_EXPORT(ComputeFaces);
HWY_EXPORT(ComputeEdges);
HWY_EXPORT(ComputeVertices);

void compute_faces(Regions& regions, const Placement& placement, std::span<FaceShape> shapes,
                   std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(ComputeFaces)(regions, placement, shapes, begin, end);
}
void compute_edges(Regions& regions, const Placement& placement, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(ComputeEdges)(regions, placement, begin, end);
}
void compute_vertices(Regions& regions, const Placement& placement, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(ComputeVertices)(regions, placement, begin, end);
}

}  // namespace sdm::sites
#endif
