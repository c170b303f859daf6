#include "bodies_report.h"

#include <algorithm>
#include <array>
#include <vector>

#include "format.h"
#include "proximity_report.h"

using Json = nlohmann::ordered_json;

namespace {

using Row = std::array<std::string, 5>;

std::string words(const sdm::BoundedLength& length) {
  if (length.certainty == sdm::Certainty::bounded)
    return fmt::format("{} ({} to {})", number(length.value), number(length.lower), number(length.upper));
  return fmt::format("{} ({})", number(length.value), name(length.certainty));
}

Row row(const sdm::PairProximity& pair) {
  return {fmt::to_string(pair.first), fmt::to_string(pair.second),
          fmt::format("{} ({})", pair.colliding ? "yes" : "no", name(sdm::Certainty::exact)),
          words(pair.separation), pair.penetration_depth ? words(*pair.penetration_depth) : "none: no solid"};
}

}  // namespace

Json to_json(const sdm::PairProximity& pair) {
  return {{"first", pair.first},
          {"second", pair.second},
          {"separation", to_json(pair.separation)},
          {"colliding", collision_json(pair.colliding)},
          {"penetration_depth", pair.penetration_depth ? to_json(*pair.penetration_depth) : Json(nullptr)}};
}

Json to_json(const sdm::BodyContact& contact) {
  Json json{{"first", contact.first}, {"second", contact.second}};
  json.update(to_json(contact.contact));
  return json;
}

std::string table(std::span<const sdm::PairProximity> pairs) {
  std::vector<Row> rows{{"first", "second", "colliding", "separation", "depth"}};
  for (const sdm::PairProximity& pair : pairs) rows.push_back(row(pair));
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
