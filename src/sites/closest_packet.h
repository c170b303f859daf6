// Closest points in the form that vector instructions fill.
#pragma once

#include <sdm/sites.h>

#include <functional>

namespace sdm::sites {

/// Closest points of the first `count` of sixteen queries, as arrays that vector instructions can fill.
struct ClosestPacket {
  static constexpr std::size_t kSize = 16;

  alignas(64) double vector[3][kSize];  ///< closest point − query
  alignas(64) double distance[kSize];
  std::uint32_t site[kSize];
  SiteType type[kSize];  ///< if `none`, the other values are undefined
  std::size_t count = 0;

  void set(std::size_t i, const Vec3& query, const ClosestPoint& c) {
    for (int k = 0; k < 3; ++k) vector[k][i] = c.point[k] - query[k];
    distance[i] = c.distance;
    site[i] = c.site;
    type[i] = c.type;
  }
  /// `face` is set only if the site is a face.
  [[nodiscard]] ClosestPoint get(std::size_t i, const Vec3& query) const {
    if (type[i] == SiteType::none) return {};
    return {.point = {query[0] + vector[0][i], query[1] + vector[1][i], query[2] + vector[2][i]},
            .distance = distance[i],
            .site = site[i],
            .type = type[i],
            .face = type[i] == SiteType::face ? site[i] : kNone};
  }
};

/// Receives closest points as they are found, for the points from index `first` on.
using ClosestSink = std::function<void(std::size_t first, const ClosestPacket& closest)>;

}  // namespace sdm::sites
