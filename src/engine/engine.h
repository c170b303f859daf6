// The one interface of the engines: closest sites for points that come in an order where neighbours are near
// each other.
#pragma once

#include <sdm/map.h>

#include <functional>
#include <span>

#include "sites/sites_data.h"

namespace sdm {

/// Closest points of the first `count` of sixteen queries, as arrays that vector instructions can fill.
struct ClosestPacket {
  static constexpr std::size_t kSize = 16;

  alignas(64) double vector[3][kSize];  ///< closest point − query
  alignas(64) double distance[kSize];
  std::uint32_t site[kSize];
  SiteType type[kSize];  ///< `none`: then only this has a meaning
  std::size_t count = 0;

  void set(std::size_t i, const Vec3& query, const ClosestPoint& c) {
    for (int k = 0; k < 3; ++k) vector[k][i] = c.point[k] - query[k];
    distance[i] = c.distance;
    site[i] = c.site;
    type[i] = c.type;
  }
  /// Without a face, unless that is the site.
  [[nodiscard]] ClosestPoint get(std::size_t i, const Vec3& query) const {
    if (type[i] == SiteType::none) return {};
    return {.point = {query[0] + vector[0][i], query[1] + vector[1][i], query[2] + vector[2][i]},
            .distance = distance[i],
            .site = site[i],
            .type = type[i],
            .face = type[i] == SiteType::face ? site[i] : kNone};
  }
};

/// Takes closest points as they are found: those of the points from `first` on.
using ClosestSink = std::function<void(std::size_t first, const ClosestPacket& closest)>;

/// Finds, for each point, the closest point of O2 within max_distance; type `none` where there is none. One
/// thread; called for batches of points from several threads at once.
using ClosestSearch = void (*)(const SitesData& sites, std::span<const Vec3> points, double max_distance,
                               const ClosestSink& deliver);

/// Scalar, double precision, best-first over the binary tree: every number to rounding.
void reference_search(const SitesData& sites, std::span<const Vec3> points, double max_distance,
                      const ClosestSink& deliver);
[[nodiscard]] ClosestPoint reference_closest(const SitesData& sites, const Vec3& point,
                                             double max_distance);

/// Groups of points against the wide tree, and lists of its sites, in single precision; the winner in double.
/// Groups are formed of neighbours in `points`. A winner can be another than the closest site only where the
/// two differ by rounding: some 10⁻⁷ of the scene's extent.
void cpu_search(const SitesData& sites, std::span<const Vec3> points, double max_distance,
                const ClosestSink& deliver);

/// The search of an engine.
ClosestSearch search_of(EngineKind engine);

}  // namespace sdm
