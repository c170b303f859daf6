#include "certify/depth/face_distances.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "certify/depth/face_distances.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <limits>

#include "geometry/vec_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::depth::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace core::HWY_NAMESPACE;

// A pair of a point and a face in each lane: the points repeat for each face.
constexpr size_t kPerFace = 4;
static_assert(2 * kPerFace == kLanes);

HWY_INLINE Vec inverse(Vec x) {
  const Doubles d;
  const Vec least = hn::Set(d, std::numeric_limits<double>::min());
  return hn::IfThenElseZero(hn::Gt(x, least), hn::Div(hn::Set(d, 1.0), hn::Max(x, least)));
}

std::array<std::array<double, 4>, 2> FaceDistances(const sites::SitesData& sites,
                                                   const std::array<Vec3, 4>& points,
                                                   const std::array<uint32_t, 2>& faces) {
  const Doubles d;
  Vec3Lanes point, corner[3];
  alignas(64) double flat[kLanes] = {};
  for (size_t f = 0; f < 2; ++f) {
    const Triangle& triangle = sites.mesh.triangles[faces[f]];
    for (size_t i = 0; i < points.size(); ++i) {
      const size_t lane = f * kPerFace + i;
      point.set(lane, points[i]);
      for (int k = 0; k < 3; ++k) corner[k].set(lane, sites.mesh.positions[triangle[k]]);
      flat[lane] = sites.sliver[faces[f]] != 0 ? 0 : 1;  // the normal of a sliver is rounding noise
    }
  }
  alignas(64) double distance[kLanes];
  for (size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
    Vec3v at[3], side[3], from[3];
    for (int k = 0; k < 3; ++k) at[k] = corner[k].load(i);
    for (int k = 0; k < 3; ++k) side[k] = sub(at[(k + 1) % 3], at[k]), from[k] = sub(point.load(i), at[k]);
    const Vec3v normal = cross(side[0], side[1]);
    Vec squared = hn::Inf(d);
    auto over = hn::Gt(hn::Load(d, flat + i), hn::Zero(d));
    for (int k = 0; k < 3; ++k) {
      const Vec t =
          hn::Min(hn::Max(hn::Mul(dot(from[k], side[k]), inverse(dot(side[k], side[k]))), hn::Zero(d)),
                  hn::Set(d, 1.0));
      const Vec3v rest = sub_mul(from[k], t, side[k]);
      squared = hn::Min(squared, dot(rest, rest));
      over = hn::And(over, hn::Gt(dot(from[k], cross(normal, side[k])), hn::Zero(d)));
    }
    const Vec height = dot(normal, from[0]);
    squared = hn::IfThenElse(over, hn::Mul(hn::Mul(height, height), inverse(dot(normal, normal))), squared);
    hn::Store(hn::Sqrt(squared), d, distance + i);
  }
  std::array<std::array<double, 4>, 2> result;
  for (size_t f = 0; f < 2; ++f)
    for (size_t i = 0; i < points.size(); ++i) result[f][i] = distance[f * kPerFace + i];
  return result;
}

}  // namespace sdm::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::depth {

HWY_EXPORT(FaceDistances);

std::array<std::array<double, 4>, 2> face_distances(const sites::SitesData& sites,
                                                    const std::array<Vec3, 4>& points,
                                                    const std::array<std::uint32_t, 2>& faces) {
  return HWY_DYNAMIC_DISPATCH(FaceDistances)(sites, points, faces);
}

}  // namespace sdm::depth
#endif
