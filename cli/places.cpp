#include "places.h"

#include <algorithm>
#include <cmath>

#include "format.h"

namespace {

std::string area_text(double area, const std::string& units) {
  return fmt::format("{}{}", number(area, 3), units.empty() ? "" : " " + units + "²");
}

std::string extent(const sdm::PlaceTotals& totals, const std::string& units, bool of_points) {
  const std::string share = number(100 * totals.fraction, 3);
  return of_points
             ? fmt::format("{} point{}, {} % of them", totals.samples, totals.samples == 1 ? "" : "s", share)
             : fmt::format("{} % of the area, {}", share, area_text(totals.area, units));
}

std::string place_text(const sdm::Place& p, const sdm::Summary& summary, double size) {
  const std::string found = summary.of_points
                                ? fmt::format("{} point{}", p.samples, p.samples == 1 ? "" : "s")
                            : p.samples == 0 ? std::string("at vertices only")
                                             : "area " + area_text(p.area, summary.units);
  const std::string value =
      std::isnan(p.distance) ? "no value" : number(p.distance) + unit_suffix(summary.units);
  return fmt::format("{} at {}, {}{}{}", value, place(p.point, size), found,
                     p.group.empty() ? "" : ", " + p.group, p.small ? ", small" : "");
}

}  // namespace

std::string place_lines(const sdm::Summary& summary, double size) {
  constexpr std::size_t kListed = 3;
  if (!summary.places || !summary.places->by_tolerance) return {};
  const sdm::Places& places = *summary.places;
  const bool of_points = summary.of_points;
  std::string text = "  places    ";
  if (places.large.count > 0)
    text += fmt::format("{} out of tolerance, with {}", places.large.count,
                        extent(places.large, summary.units, of_points));
  if (places.small.count > 0)
    text += fmt::format("{}{} small {}{} (below {:.2g} % each), together {}",
                        places.large.count > 0 ? "; and " : "", places.small.count,
                        places.small.count == 1 ? "one" : "ones",
                        places.large.count > 0 ? "" : " out of tolerance", 100 * places.least_fraction,
                        extent(places.small, summary.units, of_points));
  text += "\n";
  for (std::size_t i = 0; i < std::min(kListed, places.largest.size()); ++i)
    text += fmt::format("            {}\n", place_text(places.largest[i], summary, size));
  return text;
}
