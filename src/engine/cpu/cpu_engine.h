// The cpu engine.
#pragma once

#include "engine/engine.h"
#include "sites/sites_data.h"

namespace sdm::cpu {

using engine::ClosestSink;

/// Groups of points descend through the wide tree and lists of its sites in single precision; the winner is
/// evaluated in double. Groups are formed of neighbours in `points`. A winner can differ from the closest
/// site only where the two distances differ by rounding: about 10⁻⁷ of the scene's extent.
void cpu_search(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                const ClosestSink& sink);

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
