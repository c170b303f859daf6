// What a Surface holds.
#pragma once

#include <sdm/surface.h>

#include <mutex>
#include <optional>

#include "atlas/coverage.h"
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
  std::vector<std::array<Vec2, 3>> corners;  ///< of each face in the atlas
  std::vector<std::uint32_t> face_charts, texel_faces, samples;
  std::vector<Vec3> sample_points;

  /// Made when they are asked for, and again when vertices have moved.
  struct Lazy {
    std::once_flag measured, tiled;
    Tiles tiles;  ///< once `tiled`: see tiles_of
  };
  std::unique_ptr<Lazy> lazy = std::make_unique<Lazy>();

  /// Made when it is first asked for, and kept when vertices move.
  struct Covered {
    std::once_flag cut;
    std::optional<Coverage> coverage;  ///< once `cut`: see coverage_of
    Coverage::Radii radii;             ///< of the present positions once `Lazy::measured`
  };
  std::unique_ptr<Covered> covered = std::make_unique<Covered>();
};

}  // namespace sdm
