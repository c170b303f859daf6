// The reference engine: the oracle for all other engines.
#pragma once

#include "engine/engine.h"
#include "sites/sites_data.h"

namespace sdm::reference {

using engine::ClosestSink;

/// No face is excluded unless its box is farther than the best distance by this fraction of the distance and
/// of the size of O2. The distances of slivers that are computed from normals are accurate to 1e-7.
constexpr double kSlack = 1e-6;

/// Scalar, double precision, nearest child first over the binary tree; all results are accurate to rounding.
/// The first of all faces by (distance, type, site, face): the result depends on the faces only, not on the
/// tree.
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
