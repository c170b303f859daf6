/// How the faces of a mesh are laid out in a texture.
#pragma once

#include <sdm/progress.h>

#include <cstdint>

namespace sdm {

enum class AtlasKind {
  charts,     ///< clusters of faces with like normals, projected orthogonally
  triangles,  ///< a chart for each triangle, mapped without distortion
  uv,         ///< the mesh's own texture coordinates
};

struct AtlasOptions {
  AtlasKind kind = AtlasKind::charts;
  std::uint32_t resolution = 1024;  ///< texels a side, in [16, 32768]
  double max_stretch = 1.3;  ///< charts: lengths grow by no more from atlas to surface; > 1, 100 at most
  std::uint32_t gutter = 1;  ///< free texels around each chart, its own (charts, triangles)
  Progress progress{};
};

}  // namespace sdm
