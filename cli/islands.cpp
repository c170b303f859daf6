#include "islands.h"

#include <sdm/error.h>

#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "format.h"

namespace {

constexpr std::string_view kArea = "area:";

/// Reads "COUNT", "SHARE%" or "area:A".
std::optional<sdm::IslandLimits> limits_of(std::string_view text) {
  const bool share = text.ends_with('%'), area = text.starts_with(kArea);
  if (share) text.remove_suffix(1);
  if (area) text.remove_prefix(kArea.size());
  const auto read = [&]<class Number>(Number value) -> std::optional<Number> {
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
  };
  if (!share && !area) {
    const auto count = read(std::size_t{});
    return count && *count > 0 ? std::optional(sdm::IslandLimits{.faces = *count}) : std::nullopt;
  }
  const auto value = read(0.0);
  constexpr double kAll = 100;
  if (!value || share == area || !std::isfinite(*value) || !(*value > 0) || (share && *value > kAll))
    return std::nullopt;
  return share ? sdm::IslandLimits{.area_fraction = *value / kAll} : sdm::IslandLimits{.area = *value};
}

}  // namespace

void add_island_option(CLI::App& app, std::optional<sdm::IslandLimits>& limits) {
  app.add_option_function<std::string>(
         "--ignore-islands", [&limits](const std::string& text) { limits = limits_of(text); },
         "Leave out the components of O1 with less than COUNT faces, less than SHARE % of its area, or less "
         "than the area A, before the alignment: floating specks of a scan. Their number is reported")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return limits_of(text) ? std::string()
                                   : "'" + text + "' is not a number of faces, SHARE% or area:A above 0";
          },
          ""))
      ->type_name("COUNT|SHARE%|area:A");
}

sdm::IslandReport ignore_islands(Input& input, const sdm::IslandLimits& limits) try {
  sdm::WithoutIslands rest = sdm::remove_islands(input.mesh, limits);
  input.mesh = std::move(rest.mesh);
  for (sdm::FaceNames& kind : input.names) {
    std::vector<std::uint32_t> of_face;
    for (const std::uint32_t face : rest.face) of_face.push_back(kind.of_face[face]);
    kind.of_face = std::move(of_face);
  }
  if (rest.islands > 0)
    input.notes.push_back(
        fmt::format("{}: {} with {}, {} % of the area, left out", input.file,
                    rest.islands == 1 ? "1 island" : fmt::format("{} islands", rest.islands),
                    rest.faces == 1 ? "1 face" : fmt::format("{} faces", rest.faces),
                    number(100 * rest.area_fraction, 3)));
  return rest;
} catch (const sdm::Error& error) {
  throw sdm::Error(input.file + ": " + error.what());
}

nlohmann::ordered_json to_json(const sdm::IslandReport& islands) {
  return {{"islands", islands.islands},
          {"triangles", islands.faces},
          {"area", islands.area},
          {"area_fraction", islands.area_fraction}};
}
