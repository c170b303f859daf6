#include "certify/depth/face_distances.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "certify/depth/face_distances.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include "geometry/lanes/point_triangle-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::depth::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace lanes::HWY_NAMESPACE;

// A pair of a point and a face in each lane: the points repeat for each face.
constexpr size_t kPerFace = 4;
static_assert(2 * kPerFace == kLanes);

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
    const TriangleSides<Doubles> sides(corner[0].load(i), corner[1].load(i), corner[2].load(i));
    const auto is_flat = hn::Gt(hn::Load(d, flat + i), hn::Zero(d));
    hn::Store(hn::Sqrt(sides.squared_distance(point.load(i), is_flat)), d, distance + i);
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
