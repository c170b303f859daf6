#include "io/points/cloud_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "geometry/vec.h"

namespace sdm::io {

CloudPlaces::CloudPlaces(const PointDistances& found, const PointDistancesOptions& options, bool group_is_out,
                         const Box& usual)
    : found_(found),
      limits_(map::FaceTolerances(options.picture.tolerance, options.names, options.table), found.accuracy,
              found.distance.p99_abs),
      cells_(usual, found.points) {
  if (group_is_out) limits_.take_tolerances();
  for (const auto& extreme : {found.min, found.max})
    if (extreme) limits_.look(extreme->distance, kNone);
  if (found.beyond_max_distance + found.without_match > 0)
    limits_.look(std::numeric_limits<double>::quiet_NaN(), kNone);
}

void CloudPlaces::add(const MeasuredPoint& point, std::uint64_t number) {
  const int kind = finite(point.point) ? limits_.kind(point.distance, point.face) : 0;
  if (kind == 0) return;
  cells_.add(
      point.point, kind,
      {.points = 1,
       .distance = point.distance,
       .excess = std::isnan(point.distance) ? 0 : map::excess(point.distance, limits_.limits(point.face)),
       .point = point.point,
       .number = number,
       .face = point.face});
}

Places CloudPlaces::places(std::span<const FaceNames> names) const {
  constexpr double kLeastFraction = 1e-5, kLeastPoints = 4;
  const auto all = static_cast<double>(std::max<std::uint64_t>(found_.counted(), 1));
  Places result;
  result.limits = limits_.of_all();
  result.by_tolerance = limits_.by_tolerance();
  result.least_fraction = std::clamp(kLeastPoints / all, kLeastFraction, 1.0);
  std::vector<Place> places;
  for (const CellPoints& cluster : cells_.clusters())
    places.push_back({.distance = cluster.distance,
                      .limits = limits_.limits(cluster.face),
                      .point = cluster.point,
                      .sample = cluster.number,
                      .face = cluster.face,
                      .samples = static_cast<std::size_t>(cluster.points),
                      .fraction = static_cast<double>(cluster.points) / all});
  rank_places(std::move(places), result);
  for (Place& place : result.largest) name_group(place, names);
  return result;
}

}  // namespace sdm::io
