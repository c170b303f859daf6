// Distances of a surface to itself.
#pragma once

#include <sdm/self_proximity_query.h>

#include "map/measure.h"
#include "map/self/self_search.h"

namespace sdm::self {

class SelfMeasure final : public map::FaceMeasure {
 public:
  /// All must outlive this. Throws sdm::Error for options that do not apply.
  SelfMeasure(const Mesh& mesh, const Sites& sites, const SelfOptions& options);

  [[nodiscard]] std::unique_ptr<map::FaceSearch> search() const override;
  [[nodiscard]] bool counts_at_vertices(std::uint32_t face) const override;

 private:
  const sites::SitesData& sites_;
  const Exclusion& exclusion_;
  double max_distance_;
  PatchTree patches_;
};

}  // namespace sdm::self
