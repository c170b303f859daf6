// Time, memory and error of maps and of volumes over resolutions.
#pragma once

#include <sdm/map.h>

#include <memory>
#include <string>
#include <vector>

#include "research/fields/fields.h"
#include "research/figures/run.h"
#include "research/figures/surface_points.h"
#include "research/figures/timing.h"

namespace sdm::figures {

/// The largest errors at points of the surface, in units of the meshes.
struct SurfaceErrors {
  double nearest = 0;  ///< of the value of the nearest sample or grid point
  /// With what is stored besides: a map has a closest point for each texel, whose distance from the point is
  /// taken; a volume is interpolated linearly along each axis.
  double linear = 0;
};

[[nodiscard]] SurfaceErrors errors_of_map(const Surface& surface, const DistanceMap& map,
                                          const SurfacePoints& points);
/// Points without a value are left out.
[[nodiscard]] SurfaceErrors errors_of_field(const DistanceField& field, const SurfacePoints& points);

/// Bytes of the arrays of a map: 21 for each texel.
[[nodiscard]] double bytes_of(const DistanceMap& map);

/// One method over resolutions. Errors and bounds are relative to `unit`.
struct Method {
  std::string key{}, name{};
  std::vector<double> n{}, bytes{}, bound{}, nearest{}, linear{};
  std::vector<Times> times{};

  [[nodiscard]] std::vector<double> medians() const;
  [[nodiscard]] Json json() const;
};

struct Study {
  const Mesh& o1;
  const Sites& sites;
  const SurfacePoints& points;
  double unit;  ///< the diagonal of both meshes
};

/// Maps of n² texels; null: the cpu engine.
[[nodiscard]] Method study_maps(Run& run, const Study& study, const std::shared_ptr<const Engine>& engine,
                                const std::vector<std::uint32_t>& resolutions);
/// Volumes of n³ points around O1, which is the most favourable region: distances are asked on O1 only.
[[nodiscard]] Method study_volumes(Run& run, const Study& study, fields::Method method,
                                   const std::vector<std::uint32_t>& resolutions);

/// A box that is larger by a hundredth of its diagonal on each side.
[[nodiscard]] Box with_room(Box box);

}  // namespace sdm::figures
