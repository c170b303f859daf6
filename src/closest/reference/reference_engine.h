// The reference engine: one query at a time, the oracle for all other engines.
#pragma once

#include "closest/engine.h"

namespace sdm::reference {

class ReferenceEngine final : public Engine {
 public:
  static constexpr EngineInfo kInfo{
      .name = "reference", .summary = "simple, for verification", .relative_error = 1e-6};

  [[nodiscard]] const EngineInfo& info() const override { return kInfo; }
  void closest_points(const Sites& sites, std::span<const Vec3> points, double max_distance,
                      const sites::ClosestSink& sink) const override;
};

}  // namespace sdm::reference
