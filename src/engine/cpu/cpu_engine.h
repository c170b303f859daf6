// The cpu engine.
#pragma once

#include "engine/engine.h"
#include "sites/sites_data.h"

namespace sdm::cpu {

using engine::ClosestSink;

/// Groups of neighbouring `points` descend through the wide tree and through candidate lists in single
/// precision; the winner is evaluated in double. A winner can differ from the closest site only where the two
/// distances are equal up to rounding, about 10⁻⁷ of the scene's extent.
void cpu_search(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                const ClosestSink& sink);

/// The same for one point. Without a site within max_distance, the result has the type none.
[[nodiscard]] ClosestPoint cpu_closest(const sites::SitesData& sites, const Vec3& point, double max_distance);

class CpuEngine final : public Engine {
 public:
  static constexpr EngineInfo kInfo{.name = "cpu", .summary = "fast", .relative_error = 1e-6};

  [[nodiscard]] const EngineInfo& info() const override { return kInfo; }
  void closest_points(const Sites& sites, std::span<const Vec3> points, double max_distance,
                      const ClosestSink& sink) const override {
    cpu_search(internals(sites), points, max_distance, sink);
  }
};

}  // namespace sdm::cpu
