// Handles of Embree's devices and scenes, and meshes in scenes.
#pragma once

#include <embree3/rtcore.h>
#include <sdm/mesh.h>

#include <memory>
#include <type_traits>

namespace sdm::bench {

template <auto Release>
struct Releaser {
  template <class Handle>
  void operator()(Handle handle) const {
    Release(handle);
  }
};
using DeviceHandle = std::unique_ptr<std::remove_pointer_t<RTCDevice>, Releaser<rtcReleaseDevice>>;
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, Releaser<rtcReleaseScene>>;

/// Adds the mesh to the scene, in single precision; its triangles keep their order. Returns its geometry id.
unsigned attach(RTCDevice device, RTCScene scene, const Mesh& mesh);

/// Builds a scene of the mesh alone, ready for queries.
[[nodiscard]] SceneHandle build_scene(RTCDevice device, const Mesh& mesh, RTCBuildQuality quality);

}  // namespace sdm::bench
