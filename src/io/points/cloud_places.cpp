#include "io/points/cloud_places.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace sdm::io {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

CloudPlaces::CloudPlaces(const PointDistances& found, const std::optional<Tolerance>& tolerance,
                         const Box& usual)
    : found_(found),
      limits_(tolerance, found.accuracy, found.distance.p99_abs, found.min ? found.min->distance : kInfinity,
              found.max ? found.max->distance : -kInfinity),
      cells_(usual, found.points) {}

void CloudPlaces::add(const MeasuredPoint& point, std::uint64_t number) {
  const int side = limits_.side(point.distance);
  if (side == 0) return;
  cells_.add(point.point, side,
             {.points = 1,
              .distance = point.distance,
              .excess = map::excess(point.distance, limits_.limits()),
              .point = point.point,
              .number = number,
              .face = point.face});
}

Places CloudPlaces::places(std::span<const FaceNames> names) const {
  constexpr double kLeastFraction = 1e-5, kLeastPoints = 4;
  const auto all = static_cast<double>(std::max<std::uint64_t>(found_.counted(), 1));
  Places result;
  result.limits = limits_.limits(), result.by_tolerance = limits_.by_tolerance();
  result.least_fraction = std::max(kLeastFraction, kLeastPoints / all);
  std::vector<Place> places;
  for (const CellPoints& cluster : cells_.clusters())
    places.push_back({.distance = cluster.distance,
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
