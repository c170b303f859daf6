// Distances to the closest of the faces that face the samples.
#pragma once

#include <sdm/map.h>

#include "closest/facing/facing_search.h"
#include "map/measure.h"

namespace sdm::map {

class FacingMeasure final : public FaceMeasure {
 public:
  /// Measures points with normals: they may be behind what they match, whatever options.sign is. Throws
  /// sdm::Error for options that do not apply.
  FacingMeasure(const Sites& sites, const MapOptions& options);
  /// Measures samples of the faces of a mesh.
  FacingMeasure(const Mesh& mesh, const Sites& sites, const MapOptions& options);
  /// The same, which keeps the normals of the surface for further maps.
  FacingMeasure(const Surface& surface, const Sites& sites, const MapOptions& options);

  /// Sets `closest` to the closest points of vertices or points, by the engine of the options.
  void find_closest(const Sites& sites, const MapOptions& options, std::span<const Vec3> points);

  [[nodiscard]] std::unique_ptr<FaceSearch> search() const override;
  /// The value of a point with a normal of unit length or 0; `near`: the closest point of all of O2.
  [[nodiscard]] Value value(const Vec3& point, const Vec3& normal, const ClosestPoint& near) const;

 private:
  facing::FacingSearch search_;
  double max_distance_;
};

}  // namespace sdm::map
