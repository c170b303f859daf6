#include "proximity_report.h"

#include "bounds_text.h"
#include "format.h"
#include "src/io/json/report_json.h"

namespace {

std::string direction(const sdm::Vec3& v) {
  return fmt::format("({} {} {})", number(v[0]), number(v[1]), number(v[2]));
}

std::string words(const sdm::BoundedNumber& length, const std::string& unit) {
  const std::string bounds = length.certainty == sdm::Certainty::bounded
                                 ? "   " + bounds_text(length.lower, length.upper)
                                 : std::string();
  return fmt::format("{}{}{} ({})\n", number(length.value), unit, bounds, sdm::name_of(length.certainty));
}

std::string between(const sdm::BoundedLength& length, double size) {
  if (!length.witness) return {};
  return fmt::format("            from {} to {}\n", place((*length.witness)[0], size),
                     place((*length.witness)[1], size));
}

}  // namespace

std::string summary(sdm::ProximityQuery& query, const std::string& units, double size) {
  const std::string unit = unit_suffix(units);
  std::string text = fmt::format("  colliding  {} ({})\n", query.colliding() ? "yes" : "no",
                                 sdm::name_of(sdm::Certainty::exact));
  text += "  separation " + words(query.separation(), unit) + between(query.separation(), size);
  if (const auto& depth = query.penetration_depth())
    text += "  depth      " + words(*depth, unit) + between(*depth, size);
  else
    text += fmt::format("  depth      none: {}\n", sdm::no_depth_text(query));
  if (query.colliding()) {
    const sdm::SeparatingTranslation& found = query.separating_translation();
    text += "  to leave   " + words(found, unit);
    text += fmt::format("            moving O1 by {}\n", direction(found.translation));
  }
  const std::span<const sdm::Contact> contacts = query.contacts();
  if (contacts.empty()) return text + "  contacts   0\n";
  const std::size_t patches = sdm::patch_count(contacts);
  const sdm::Contact& deepest = contacts.front();
  return text + fmt::format("  contacts   {} in {} {}; the deepest, {}{}, pushes O1 along {}\n",
                            contacts.size(), patches, patches == 1 ? "patch" : "patches",
                            number(deepest.depth), unit, direction(deepest.normal));
}
