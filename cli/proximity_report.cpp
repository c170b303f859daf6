#include "proximity_report.h"

#include "report.h"

using Json = nlohmann::ordered_json;

const char* name(sdm::Certainty kind) {
  return kind == sdm::Certainty::exact ? "exact" : kind == sdm::Certainty::bounded ? "bounded" : "estimate";
}

Json to_json(const sdm::BoundedLength& length) {
  return {{"value", length.value},
          {"kind", name(length.kind)},
          {"lower", length.lower},
          {"upper", length.upper},
          {"witness", length.witness ? Json(*length.witness) : Json(nullptr)}};
}

Json to_json(const sdm::Contact& contact) {
  return {{"point1", contact.point1},
          {"point2", contact.point2},
          {"normal", contact.normal},
          {"depth", contact.depth},
          {"patch", contact.patch}};
}

Json to_json(const sdm::BoundedBool& decision) {
  return {{"value", decision.value}, {"kind", name(decision.kind)}};
}

namespace {

// Why there is no depth.
std::string no_solid(const sdm::Query& query) {
  const auto reason = [&](int body) {
    std::string text = sdm::choose_sign(query.sites(body), sdm::SignMethod::automatic).reason;
    if (body == 0) text.replace(text.find("O2"), 2, "O1");
    return text;
  };
  return reason(0) + "; " + reason(1);
}

std::size_t patch_count(std::span<const sdm::Contact> contacts) {
  return contacts.empty() ? 0 : contacts.back().patch + 1;
}

std::string point(const sdm::Vec3& p) {
  std::string text = number(p[0]);
  for (const double x : {p[1], p[2]}) text.append(" ").append(number(x));
  return text.insert(0, 1, '(').append(")");
}

std::string words(const sdm::BoundedLength& length, const std::string& unit) {
  std::string text = number(length.value) + unit;
  if (length.kind == sdm::Certainty::bounded)
    text += "   between " + number(length.lower) + " and " + number(length.upper);
  return text + " (" + name(length.kind) + ")\n";
}

std::string between(const sdm::BoundedLength& length) {
  if (!length.witness) return {};
  return "            from " + point((*length.witness)[0]) + " to " + point((*length.witness)[1]) + "\n";
}

}  // namespace

Json to_json(sdm::Query& query) {
  Json json;
  json["separation"] = to_json(query.separation());
  json["colliding"] = to_json(query.colliding());
  if (const auto& depth = query.penetration_depth()) {
    json["penetration_depth"] = to_json(*depth);
  } else {
    json["penetration_depth"] = nullptr;
    json["no_penetration_depth"] = no_solid(query);
  }
  json["contacts"] = Json::array();
  for (const sdm::Contact& contact : query.contacts()) json["contacts"].push_back(to_json(contact));
  json["patches"] = patch_count(query.contacts());
  return json;
}

std::string summary(sdm::Query& query, const std::string& units) {
  const std::string unit = units.empty() ? "" : " " + units;
  const sdm::BoundedBool colliding = query.colliding();
  std::string text =
      std::string("  colliding  ") + (colliding.value ? "yes (" : "no (") + name(colliding.kind) + ")\n";
  text += "  separation " + words(query.separation(), unit);
  text += between(query.separation());
  if (const auto& depth = query.penetration_depth()) {
    text += "  depth      " + words(*depth, unit);
    text += between(*depth);
  } else {
    text += "  depth      none: " + no_solid(query) + "\n";
  }
  const std::span<const sdm::Contact> contacts = query.contacts();
  text += "  contacts   " + std::to_string(contacts.size());
  if (!contacts.empty()) {
    const sdm::Contact& deepest = contacts.front();
    text += " in " + std::to_string(patch_count(contacts)) +
            (patch_count(contacts) == 1 ? " patch" : " patches") + "; the deepest, " + number(deepest.depth) +
            unit + ", pushes O1 along " + point(deepest.normal);
  }
  return text + "\n";
}
