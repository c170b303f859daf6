#include "embree_rays.h"

namespace sdm::bench {

EmbreeOccluder::EmbreeOccluder(const Mesh& mesh)
    : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_.get())) {
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST);
  // A low quality of the scene makes that of a geometry count.
  rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_LOW);
  geometry_ = attach(device_.get(), scene_.get(), mesh);
  const RTCGeometry geometry = rtcGetGeometry(scene_.get(), geometry_);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
  rtcCommitGeometry(geometry);
  rtcCommitScene(scene_.get());
}

void EmbreeOccluder::update(std::span<const Vec3> positions) {
  const RTCGeometry geometry = rtcGetGeometry(scene_.get(), geometry_);
  auto* to = static_cast<Vec3f*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
  for (std::size_t i = 0; i < positions.size(); ++i)
    for (int k = 0; k < 3; ++k) to[i][k] = static_cast<float>(positions[i][k]);
  rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(geometry);
  rtcCommitScene(scene_.get());
}

void EmbreeOccluder::occluded(std::span<const Ray> rays, std::uint8_t* result) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& ray = rays[i];
    RTCRay one{};
    one.org_x = static_cast<float>(ray.origin[0]);
    one.org_y = static_cast<float>(ray.origin[1]);
    one.org_z = static_cast<float>(ray.origin[2]);
    one.dir_x = static_cast<float>(ray.direction[0]);
    one.dir_y = static_cast<float>(ray.direction[1]);
    one.dir_z = static_cast<float>(ray.direction[2]);
    one.tnear = static_cast<float>(ray.t_min);
    one.tfar = static_cast<float>(ray.t_max);
    one.mask = ~0u;
    rtcOccluded1(scene_.get(), &context, &one);
    result[i] = one.tfar < 0;  // −∞ if occluded
  }
}

}  // namespace sdm::bench
