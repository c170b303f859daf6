// Meshes for Embree.
#pragma once

#include <embree3/rtcore.h>
#include <sdm/mesh.h>

namespace sdm::bench {

/// Adds the mesh to the scene, in single precision; its triangles keep their order. Returns its geometry id.
unsigned attach(RTCDevice device, RTCScene scene, const Mesh& mesh);

}  // namespace sdm::bench
