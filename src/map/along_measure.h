// Distances along lines.
#pragma once

#include <sdm/measure.h>

#include "map/measure.h"
#include "sites/sites_data.h"

namespace sdm::map {

class AlongMeasure final : public FaceMeasure {
 public:
  /// Measures points. Throws sdm::Error for options out of range.
  AlongMeasure(const Sites& sites, const AlongOptions& options);
  /// Measures samples of the faces of a mesh.
  AlongMeasure(const Mesh& mesh, const Sites& sites, const AlongOptions& options);

  [[nodiscard]] std::unique_ptr<FaceSearch> search() const override;

 private:
  void group_by_side();

  const sites::SitesData& sites_;
  double max_distance_;
  std::optional<Vec3> direction_;  ///< of unit length
};

}  // namespace sdm::map
