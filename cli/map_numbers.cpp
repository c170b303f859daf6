#include "map_numbers.h"

#include <algorithm>
#include <cmath>

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t kBins = 100;
constexpr std::size_t kMostRows = 50;  // of a table of parts

// The range of the histogram: that of the distances but for those beyond the 99th percentile of |d|, and the
// tolerance.
sdm::DistanceHistogram histogram(const sdm::Surface& surface, const sdm::DistanceMap& map,
                                 const sdm::DistanceStatistics& d,
                                 const std::optional<sdm::Tolerance>& tolerance) {
  double lo = std::max(d.min, -d.p99_abs), hi = std::min(d.max, d.p99_abs);
  if (tolerance) {
    const bool is_signed = map.sign.method != sdm::SignMethod::none;
    lo = std::min(lo, is_signed ? tolerance->lo : std::max(0.0, tolerance->lo));
    hi = std::max(hi, tolerance->hi);
  }
  if (!(lo < hi)) {  // a single value, or all values beyond the percentile on one side
    lo = std::min(d.min, lo), hi = std::max(d.max, hi);
    const double widen = lo < hi ? 0 : lo != 0 ? std::abs(lo) / 2 : 1;
    lo -= widen, hi += widen;
  }
  return sdm::distance_histogram(surface, map, lo, hi, kBins);
}

PartTable part_table(const sdm::Surface& surface, const sdm::DistanceMap& map, std::string kind,
                     std::span<const std::uint32_t> part_of_face, std::span<const std::string> names,
                     std::size_t parts, const std::optional<sdm::Tolerance>& tolerance, double accuracy) {
  PartTable table{.kind = std::move(kind), .count = 0, .rows = {}};
  std::vector<sdm::PartStatistics> all =
      sdm::part_statistics(surface, map, part_of_face, parts, tolerance, accuracy);
  for (std::size_t p = 0; p < parts; ++p)
    table.rows.push_back({p < names.size() ? names[p] : "", std::move(all[p]), sdm::kNone});
  for (std::uint32_t f = 0; f < part_of_face.size(); ++f)
    if (const std::uint32_t p = part_of_face[f]; p != sdm::kNone && table.rows[p].first_face == sdm::kNone)
      table.rows[p].first_face = f;
  std::erase_if(table.rows, [](const PartTable::Row& row) { return row.part.faces == 0; });
  table.count = table.rows.size();
  std::ranges::stable_sort(table.rows, std::ranges::greater(),
                           [](const PartTable::Row& row) { return row.part.area_fraction; });
  table.rows.resize(std::min(table.rows.size(), kMostRows));
  return table;
}

// The faces without a name are a part of their own, if there are any.
PartTable named_parts(const sdm::Surface& surface, const sdm::DistanceMap& map, const sdm::FaceNames& names,
                      const std::optional<sdm::Tolerance>& tolerance, double accuracy) {
  std::vector<std::uint32_t> part_of_face = names.of_face;
  const auto unnamed = static_cast<std::uint32_t>(names.names.size());
  std::ranges::replace(part_of_face, sdm::kNone, unnamed);
  std::vector<std::uint8_t> used(unnamed + 1);
  for (const std::uint32_t part : part_of_face) used[part] = 1;
  if (std::ranges::count(used, 1) < 2)
    return {.kind = names.kind, .count = static_cast<std::size_t>(std::ranges::count(used, 1)), .rows = {}};
  return part_table(surface, map, names.kind, part_of_face, names.names, unnamed + 1, tolerance, accuracy);
}

Json shares_json(const sdm::ToleranceShares& shares) {
  return {{"below", shares.below},
          {"within", shares.within},
          {"above", shares.above},
          {"without_value", shares.without_value}};
}

Json table_json(const PartTable& table, bool with_tolerance) {
  Json rows = Json::array();
  for (const auto& [name, part, first_face] : table.rows) {
    Json row;
    if (table.kind != "component") row["name"] = name.empty() ? Json() : Json(name);
    row["triangles"] = part.faces;
    row["first_triangle"] = first_face;
    row["bounds"] = {{"lo", part.box.lo}, {"hi", part.box.hi}};
    row["area_fraction"] = part.area_fraction;
    row["distance"] = to_json(part.distance);
    row["texels_with_value"] = part.distance.texels;
    if (with_tolerance) row["tolerance"] = shares_json(part.tolerance);
    rows.push_back(std::move(row));
  }
  return {{"kind", table.kind}, {"count", table.count}, {"largest", std::move(rows)}};
}

}  // namespace

std::vector<double> default_bands(const sdm::Tolerance& tolerance, bool is_signed) {
  const auto [lo, hi] = tolerance;
  std::vector<double> edges;
  if (lo <= 0 && hi >= 0)
    edges = {2 * lo, lo, lo / 2, hi / 2, hi, 2 * hi};
  else
    edges = {2 * lo - hi, lo, (lo + hi) / 2, hi, 2 * hi - lo};
  const auto omitted = [&](double edge) { return !is_signed && edge <= 0; };
  std::erase_if(edges, omitted);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

MapNumbers map_numbers(const sdm::Surface& surface, const sdm::DistanceMap& map,
                       const sdm::DistanceStatistics& distance, const PartSource& source,
                       std::vector<double> edges, const std::optional<sdm::Tolerance>& tolerance,
                       double accuracy) {
  MapNumbers numbers{.histogram = {}, .bands = {}, .parts = {}, .tolerance = tolerance.has_value()};
  if (!std::isfinite(accuracy)) accuracy = 0;
  if (distance.texels > 0) numbers.histogram = histogram(surface, map, distance, tolerance);
  if (edges.empty() && tolerance) edges = default_bands(*tolerance, map.sign.method != sdm::SignMethod::none);
  if (!edges.empty()) {
    const double centre = tolerance ? tolerance->lo + (tolerance->hi - tolerance->lo) / 2 : 0;
    numbers.bands = sdm::distance_bands(surface, map, edges, accuracy, centre);
  }
  // The values of the mesh's faces for those of the surface.
  const auto of_surface = [&](std::vector<std::uint32_t> of_mesh) {
    if (source.source_face.empty()) return of_mesh;
    std::vector<std::uint32_t> result;
    for (const std::uint32_t face : source.source_face) result.push_back(of_mesh[face]);
    return result;
  };
  PartTable all{.kind = "component", .count = source.components, .rows = {}};
  if (source.components > 1)
    all = part_table(surface, map, "component", of_surface(sdm::face_components(source.mesh)), {},
                     source.components, tolerance, accuracy);
  numbers.parts.push_back(std::move(all));
  for (const sdm::FaceNames& kind : source.names) {
    const sdm::FaceNames names{kind.kind, kind.names, of_surface(kind.of_face)};
    numbers.parts.push_back(named_parts(surface, map, names, tolerance, accuracy));
  }
  return numbers;
}

const char* verdict_name(sdm::Verdict verdict) {
  switch (verdict) {
    case sdm::Verdict::pass:
      return "PASS";
    case sdm::Verdict::fail:
      return "FAIL";
    case sdm::Verdict::not_decided:
      return "NOT DECIDED";
  }
  return "";
}

Json to_json(const sdm::DistanceStatistics& d) {
  // NaN, if no texel has a value, becomes null.
  return {{"kind", "estimate"},
          {"min", d.min},
          {"max", d.max},
          {"mean", d.mean},
          {"rms", d.rms},
          {"stddev", d.stddev},
          {"p01", d.p01},
          {"p05", d.p05},
          {"p50", d.p50},
          {"p95", d.p95},
          {"p99", d.p99},
          {"mean_abs", d.mean_abs},
          {"max_abs", d.max_abs},
          {"p50_abs", d.p50_abs},
          {"p95_abs", d.p95_abs},
          {"p99_abs", d.p99_abs},
          {"negative_area_fraction", d.negative_area_fraction}};
}

Json to_json(const sdm::ToleranceVerdict& verdict) {
  const auto [lo, hi] = verdict.tolerance;
  Json json;
  json["value"] = lo == -hi ? Json(hi) : Json();
  json["lower"] = lo;
  json["upper"] = hi;
  json["verdict"] = verdict_name(verdict.verdict);
  json["exceeded_area_fraction"] = verdict.exceeded_area_fraction;
  json["area_fractions"] = shares_json(verdict.shares);
  json["within"] = verdict.within;
  json["certified"] = verdict.certified;
  json["deciding_precision"] = verdict.deciding_bound > 0 ? Json(verdict.deciding_bound) : Json();
  return json;
}

Json to_json(const MapNumbers& numbers) {
  Json json;
  json["histogram"] = nullptr;
  if (const auto& h = numbers.histogram)
    json["histogram"] = {{"lower", h->lo},    {"upper", h->hi},    {"area_fractions", h->area_fractions},
                         {"below", h->below}, {"above", h->above}, {"without_value", h->without_value}};
  json["bands"] = Json::array();
  for (const sdm::DistanceBand& band : numbers.bands)  // null: no limit
    json["bands"].push_back({{"lower", band.lo}, {"upper", band.hi}, {"area_fraction", band.area_fraction}});
  json["components"] = table_json(numbers.parts.front(), numbers.tolerance);
  json["groups"] = Json::array();
  for (std::size_t i = 1; i < numbers.parts.size(); ++i)
    json["groups"].push_back(table_json(numbers.parts[i], numbers.tolerance));
  return json;
}
