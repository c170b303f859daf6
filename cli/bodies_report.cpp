#include "bodies_report.h"

#include <algorithm>
#include <array>
#include <vector>

#include "bounds_text.h"
#include "format.h"

namespace {

using Row = std::array<std::string, 5>;

std::string words(const sdm::BoundedLength& length) {
  if (length.certainty == sdm::Certainty::bounded)
    return fmt::format("{} ({} to {})", number(length.value), lower_number(length.lower),
                       upper_number(length.upper));
  return fmt::format("{} ({})", number(length.value), sdm::name_of(length.certainty));
}

Row row(const PairResults& pair) {
  return {
      fmt::to_string(pair.separation.first), fmt::to_string(pair.separation.second),
      fmt::format("{} ({})", pair.separation.colliding ? "yes" : "no", sdm::name_of(sdm::Certainty::exact)),
      words(pair.separation.separation),
      pair.penetration_depth ? words(*pair.penetration_depth) : "none: no solid"};
}

bool solid(const sdm::Sites& sites) {
  return sites.closed() && sites.orientable();
}

}  // namespace

std::vector<PairResults> results_of(sdm::MultiBodyQuery& bodies, double max_distance) {
  const std::span<const sdm::PairDepth> depths = bodies.penetration_depths();
  auto depth = depths.begin();
  std::vector<PairResults> results;
  for (const sdm::PairSeparation& pair : bodies.separations(max_distance)) {
    PairResults& result = results.emplace_back(PairResults{.separation = pair});
    if (!solid(bodies.sites(pair.first)) && !solid(bodies.sites(pair.second))) continue;
    result.penetration_depth = pair.colliding ? (depth++)->penetration_depth
                                              : sdm::BoundedLength{{.certainty = sdm::Certainty::exact}};
  }
  return results;
}

std::string table(std::span<const PairResults> pairs) {
  std::vector<Row> rows{{"first", "second", "colliding", "separation", "depth"}};
  for (const PairResults& pair : pairs) rows.push_back(row(pair));
  std::array<std::size_t, std::tuple_size_v<Row>> widths{};
  for (const Row& cells : rows)
    for (std::size_t c = 0; c < cells.size(); ++c) widths[c] = std::max(widths[c], cells[c].size());
  std::string text;
  for (const Row& cells : rows) {
    for (std::size_t c = 0; c + 1 < cells.size(); ++c) text += fmt::format("  {:<{}}", cells[c], widths[c]);
    text += fmt::format("  {}\n", cells.back());
  }
  return text;
}
