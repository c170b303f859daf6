// The cpu engine: candidate lists for groups of neighbouring samples, searches for scattered points, and
// vector instructions.
#pragma once

#include "closest/closest_points.h"
#include "closest/engine.h"
#include "closest/scattered.h"
#include "sites/sites_data.h"

namespace sdm::cpu {

class CpuEngine final : public Engine {
 public:
  static constexpr EngineInfo kInfo{.name = "cpu", .summary = "fast", .relative_error = 1e-6};

  [[nodiscard]] const EngineInfo& info() const override { return kInfo; }
  void closest_points(const Sites& sites, std::span<const Vec3> points, double max_distance,
                      const sites::ClosestSink& sink) const override {
    closest::closest_points(internals(sites), points, max_distance, sink);
  }
  void scattered(const Sites& sites, std::span<const Vec3> points, const engine::EngineOptions& options,
                 std::span<ClosestPoint> found) const override {
    closest::find_scattered(internals(sites), points, options.max_distance, options.progress, found);
  }
};

}  // namespace sdm::cpu
