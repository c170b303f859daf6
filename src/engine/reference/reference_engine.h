// The reference engine: the oracle for all other engines.
#pragma once

#include "engine/engine.h"
#include "sites/sites_data.h"

namespace sdm::reference {

using engine::ClosestSink;

/// Scalar, double precision, best-first over the binary tree; all results are accurate to rounding.
[[nodiscard]] ClosestPoint reference_closest(const sites::SitesData& sites, const Vec3& point,
                                             double max_distance);

class ReferenceEngine final : public Engine {
 public:
  static constexpr EngineInfo kInfo{
      .name = "reference", .summary = "simple, for verification", .relative_error = 1e-6};

  [[nodiscard]] const EngineInfo& info() const override { return kInfo; }
  void closest_points(const Sites& sites, std::span<const Vec3> points, double max_distance,
                      const ClosestSink& sink) const override;
};

}  // namespace sdm::reference
