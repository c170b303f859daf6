// The reference engine: one query at a time, the oracle for all other engines.
#pragma once

#include <sdm/sites.h>

#include "closest/engine.h"
#include "sites/sites_data.h"

namespace sdm::reference {

/// Scalar, double precision; accurate to rounding. The first of all faces by (distance, type, site, face):
/// the result depends on the faces only, not on the tree.
[[nodiscard]] ClosestPoint reference_closest(const sites::SitesData& sites, const Vec3& q,
                                             double max_distance);

class ReferenceEngine final : public Engine {
 public:
  static constexpr EngineInfo kInfo{
      .name = "reference", .summary = "simple, for verification", .relative_error = 1e-6};

  [[nodiscard]] const EngineInfo& info() const override { return kInfo; }
  void closest_points(const Sites& sites, std::span<const Vec3> points, double max_distance,
                      const sites::ClosestSink& sink) const override;
};

}  // namespace sdm::reference
