// The data of Surface.
#pragma once

#include <sdm/surface.h>

#include <mutex>
#include <optional>

#include "atlas/layout.h"
#include "surface/sampling_bound/coverage.h"
#include "surface/tiles.h"

namespace sdm::surface {

struct SurfaceData {
  Mesh mesh;
  AtlasKind kind = AtlasKind::charts;
  std::uint32_t resolution = 0;
  std::size_t chart_count = 0;
  double max_stretch = 1;
  std::vector<atlas::FaceMap> maps;
  std::vector<std::array<Vec2, 3>> corners;  ///< of each face in the atlas
  std::vector<std::uint32_t> face_charts, texel_faces, samples;
  std::vector<std::uint32_t> sample_faces;  ///< samples in spatial order are scattered over texel_faces

  /// Computed on first use, by the first thread that needs it.
  struct Lazy {
    std::once_flag tiled, cut;
    Tiles tiles;                       ///< once `tiled`: see tiles_of
    std::optional<Coverage> coverage;  ///< once `cut`: see coverage_of

    /// Of the present positions; made anew when vertices move.
    struct Present {
      std::once_flag placed, measured;
    };
    std::optional<Present> present{std::in_place};
    std::vector<Vec3> sample_points;  ///< once `placed`
    Coverage::Radii radii;            ///< once `measured`: see radii_of
  };
  mutable Lazy lazy;
};

/// Sets `points` to those of the samples from `first` on.
void place_samples(const SurfaceData& surface, std::size_t first, std::span<Vec3> points);

}  // namespace sdm::surface

namespace sdm {

/// The data of Surface. Found by argument-dependent lookup.
[[nodiscard]] inline const surface::SurfaceData& internals(const Surface& surface) {
  return *surface.data_;
}

}  // namespace sdm
