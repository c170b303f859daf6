#include "sequence_distances.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "format.h"

using Json = nlohmann::ordered_json;

void FrameDistances::withhold_pass() {
  if (verdict == sdm::Verdict::pass) verdict = sdm::Verdict::doubtful;
}

FrameDistances frame_distances(const sdm::Surface& surface, const sdm::Sites& sites,
                               const sdm::DistanceMap& map, const std::optional<sdm::Tolerance>& tolerance,
                               sdm::CertifyOptions options) {
  const std::vector<float> at_vertices = sdm::distances_at_vertices(surface.mesh(), sites);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::optional<sdm::Extremes> found = sdm::extremes(surface, map, at_vertices);
  FrameDistances result{.min = found ? found->min.distance : kNan,
                        .mean = sdm::statistics(surface, map).mean,
                        .max = found ? found->max.distance : kNan};
  if (!tolerance) return result;
  options.accuracy = sdm::engine_accuracy(sdm::engines().front(), surface.mesh(), sites.mesh());
  const sdm::CertifiedVerdict verdict =
      sdm::certify_tolerance(surface, sites, map, at_vertices, *tolerance, options);
  result.doubt = sdm::doubt_of(verdict);
  result.verdict = verdict.verdict;
  result.certified = verdict.certified;
  result.guard = options.guard + options.uncertainty;
  result.exceeded_area_fraction = verdict.exceeded_area_fraction;
  return result;
}

Json to_json(const FrameDistances& d) {
  Json json{{"kind", "estimate"}, {"min", d.min}, {"mean", d.mean}, {"max", d.max}};
  if (d.verdict) {
    json["verdict"] = sdm::name_of(*d.verdict);
    json["exceeded_area_fraction"] = d.exceeded_area_fraction;
    json["certified"] = d.certified;
    json["guard"] = d.guard;
  }
  return json;
}

FrameDistances distances_from(const Json& json) {
  const auto number = [&](const char* key) {
    return json.at(key).is_null() ? std::numeric_limits<double>::quiet_NaN() : json.at(key).get<double>();
  };
  FrameDistances d{.min = number("min"), .mean = number("mean"), .max = number("max")};
  if (!json.contains("verdict")) return d;
  d.verdict = sdm::value_of<sdm::Verdict>(json.at("verdict").get<std::string>());
  d.exceeded_area_fraction = json.at("exceeded_area_fraction");
  d.certified = json.value("certified", false);
  d.guard = json.value("guard", 0.0);
  return d;
}

std::string distance_columns(const std::string& body) {
  return fmt::format(",distance_min_{0},distance_mean_{0},distance_max_{0},verdict_{0}", body);
}

std::vector<std::string> cells(const std::optional<FrameDistances>& distances) {
  std::vector<std::string> result(4);
  if (!distances) return result;
  const double values[] = {distances->min, distances->mean, distances->max};
  for (std::size_t i = 0; i < 3; ++i)
    if (!std::isnan(values[i])) result[i] = number(values[i], 9);
  if (distances->verdict) result[3] = sdm::name_of(*distances->verdict);
  return result;
}
