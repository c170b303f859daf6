#include "embree_mesh.h"

#include <algorithm>

namespace sdm::bench {

unsigned attach(RTCDevice device, RTCScene scene, const Mesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* positions = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), mesh.positions.size()));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    for (int k = 0; k < 3; ++k) positions[i][k] = static_cast<float>(mesh.positions[i][k]);
  auto* indices = static_cast<Triangle*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), mesh.triangles.size()));
  std::ranges::copy(mesh.triangles, indices);
  rtcCommitGeometry(geometry);
  const unsigned id = rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  return id;
}

SceneHandle build_scene(RTCDevice device, const Mesh& mesh, RTCBuildQuality quality) {
  SceneHandle scene(rtcNewScene(device));
  rtcSetSceneBuildQuality(scene.get(), quality);
  attach(device, scene.get(), mesh);
  rtcCommitScene(scene.get());
  return scene;
}

}  // namespace sdm::bench
