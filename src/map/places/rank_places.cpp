#include <sdm/places.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>

#include "map/places/place_limits.h"

namespace sdm {
namespace {

// The first of equals stays the first, so that the list depends on nothing else.
void list_largest(std::vector<Place> all, Places& result) {
  std::ranges::stable_sort(all, std::greater(), [](const Place& place) {
    const bool has_value = !std::isnan(place.distance);
    return std::tuple(!place.small, has_value,
                      has_value ? map::excess(place.distance, place.limits) : place.fraction);
  });
  all.resize(std::min(all.size(), Places::kListed));
  result.largest = std::move(all);
}

}  // namespace

void rank_places(std::vector<Place> all, Places& result) {
  for (Place& place : all) {
    place.small = place.fraction < result.least_fraction;
    PlaceTotals& totals = place.small ? result.small : result.large;
    ++totals.count, totals.samples += place.samples;
    totals.area += place.area, totals.fraction += place.fraction;
  }
  list_largest(std::move(all), result);
}

void name_group(Place& place, std::span<const FaceNames> names) {
  if (place.face == kNone) return;
  for (const FaceNames& kind : names)
    if (const std::uint32_t name = kind.of_face[place.face]; name != kNone) {
      place.kind = kind.kind, place.group = kind.names[name];
      return;
    }
}

std::optional<Places> combined_places(std::span<const Places> places, std::span<const double> areas) {
  double all_area = 0;
  for (const double area : areas) all_area += area;
  std::optional<Places> result;
  std::vector<Place> all;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Places& part = places[i];
    if (!part.by_tolerance) continue;
    const double share = all_area > 0 ? areas[i] / all_area : 0;
    if (!result) result.emplace().limits = part.limits, result->by_tolerance = true;
    result->least_fraction = std::max(result->least_fraction, share * part.least_fraction);
    for (const auto& [totals, of_part] :
         {std::pair(&result->large, &part.large), std::pair(&result->small, &part.small)}) {
      totals->count += of_part->count, totals->samples += of_part->samples;
      totals->area += of_part->area, totals->fraction += share * of_part->fraction;
    }
    for (Place place : part.largest) {
      place.fraction *= share;
      all.push_back(std::move(place));
    }
  }
  if (result) list_largest(std::move(all), *result);
  return result;
}

}  // namespace sdm
