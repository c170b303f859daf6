// What a Surface holds.
#pragma once

#include <sdm/surface.h>

#include <mutex>

#include "atlas/layout.h"
#include "atlas/tiles.h"

namespace sdm {

struct Surface::Impl {
  Mesh mesh;
  AtlasKind kind = AtlasKind::charts;
  std::uint32_t resolution = 0;
  std::size_t chart_count = 0;
  double max_stretch = 1;
  std::vector<FaceMap> maps;
  std::vector<std::uint32_t> face_charts, texel_faces, samples;
  std::vector<Vec3> sample_points;
  std::once_flag bounded;
  double sampling_bound = 0;  ///< once `bounded`
  mutable std::once_flag tiled{};
  mutable Tiles tiles{};  ///< once `tiled`: see tiles_of
};

}  // namespace sdm
