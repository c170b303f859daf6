#include "summary/distribution.h"

#include <algorithm>
#include <cmath>

namespace sdm {
namespace summary {
namespace {

constexpr std::size_t kBins = 100;
constexpr std::size_t kMostRows = 50;  // of a table of parts

// The range of the histogram: that of the distances but for those beyond the 99th percentile of |d|, and the
// tolerance.
DistanceHistogram histogram(const Surface& surface, const DistanceMap& map, const DistanceStatistics& d,
                            const std::optional<Tolerance>& tolerance) {
  double lo = std::max(d.min, -d.p99_abs), hi = std::min(d.max, d.p99_abs);
  if (tolerance) {
    const bool is_signed = map.sign.method != SignMethod::none;
    if (std::isfinite(tolerance->lower))
      lo = std::min(lo, is_signed ? tolerance->lower : std::max(0.0, tolerance->lower));
    if (std::isfinite(tolerance->upper)) hi = std::max(hi, tolerance->upper);
  }
  if (!(lo < hi)) {  // a single value, or all values beyond the percentile on one side
    lo = std::min(d.min, lo);
    hi = std::max(d.max, hi);
    const double widen = lo < hi ? 0 : lo != 0 ? std::abs(lo) / 2 : 1;
    lo -= widen;
    hi += widen;
  }
  return distance_histogram(surface, map, {lo, hi}, kBins);
}

PartTable part_table(const Surface& surface, const DistanceMap& map, std::string kind,
                     std::span<const std::uint32_t> part_of_face, std::span<const std::string> names,
                     std::size_t parts, const std::optional<Tolerance>& tolerance, double accuracy) {
  PartTable table{.kind = std::move(kind), .count = 0, .rows = {}};
  std::vector<PartStatistics> all =
      part_statistics(surface, map, part_of_face, parts, {.tolerance = tolerance, .accuracy = accuracy});
  for (std::size_t p = 0; p < parts; ++p)
    table.rows.push_back({p < names.size() ? names[p] : "", std::move(all[p]), kNone});
  for (std::uint32_t f = 0; f < part_of_face.size(); ++f)
    if (const std::uint32_t p = part_of_face[f]; p != kNone && table.rows[p].first_face == kNone)
      table.rows[p].first_face = f;
  std::erase_if(table.rows, [](const PartTable::Row& row) { return row.part.faces == 0; });
  table.count = table.rows.size();
  std::ranges::stable_sort(table.rows, std::ranges::greater(),
                           [](const PartTable::Row& row) { return row.part.area_fraction; });
  table.rows.resize(std::min(table.rows.size(), kMostRows));
  return table;
}

// The faces without a name are a part of their own, if there are any.
PartTable named_parts(const Surface& surface, const DistanceMap& map, const FaceNames& names,
                      const std::optional<Tolerance>& tolerance, double accuracy) {
  std::vector<std::uint32_t> part_of_face = names.of_face;
  const auto unnamed = static_cast<std::uint32_t>(names.names.size());
  std::ranges::replace(part_of_face, kNone, unnamed);
  std::vector<std::uint8_t> used(unnamed + 1);
  for (const std::uint32_t part : part_of_face) used[part] = 1;
  if (std::ranges::count(used, 1) < 2)
    return {.kind = names.kind, .count = static_cast<std::size_t>(std::ranges::count(used, 1)), .rows = {}};
  return part_table(surface, map, names.kind, part_of_face, names.names, unnamed + 1, tolerance, accuracy);
}

/// The values of the faces of the whole mesh for those of the surface.
std::vector<std::uint32_t> of_surface(const SummaryOptions& options, std::vector<std::uint32_t> of_whole) {
  if (options.whole_face.empty()) return of_whole;
  std::vector<std::uint32_t> result;
  for (const std::uint32_t face : options.whole_face) result.push_back(of_whole[face]);
  return result;
}

std::vector<PartTable> part_tables(const Surface& surface, const DistanceMap& map,
                                   const SummaryOptions& options, double accuracy) {
  const Mesh& whole = options.whole ? *options.whole : surface.mesh();
  std::vector<std::uint32_t> components = face_components(whole);
  const auto count =
      static_cast<std::size_t>(std::ranges::max(components, {}, [](std::uint32_t c) { return c + 1; }) + 1);
  std::vector<PartTable> tables;
  PartTable all{.kind = "component", .count = count, .rows = {}};
  if (count > 1)
    all = part_table(surface, map, "component", of_surface(options, std::move(components)), {}, count,
                     options.tolerance, accuracy);
  tables.push_back(std::move(all));
  for (const FaceNames& kind : options.names) {
    const FaceNames names{kind.kind, kind.names, of_surface(options, kind.of_face)};
    tables.push_back(named_parts(surface, map, names, options.tolerance, accuracy));
  }
  return tables;
}

/// The middle of a tolerance, infinite if a limit is.
double centre_of(const std::optional<Tolerance>& tolerance) {
  if (!tolerance) return 0;
  const auto [lo, hi] = *tolerance;
  return std::isinf(lo) ? lo : lo + (hi - lo) / 2;
}

/// The edges of bands on both sides of a limit that is the only one.
std::vector<double> edges_around(double limit) {
  if (limit == 0) return {limit};
  return limit > 0 ? std::vector{limit / 2, limit, 2 * limit} : std::vector{2 * limit, limit, limit / 2};
}

}  // namespace

Distribution distribution_of(const Surface& surface, const DistanceMap& map,
                             const DistanceStatistics& distance, const SummaryOptions& options) {
  Distribution result;
  const double accuracy = std::isfinite(options.accuracy) ? options.accuracy : 0;
  const std::optional<Tolerance>& tolerance = options.tolerance;
  if (distance.texels > 0) result.histogram = histogram(surface, map, distance, tolerance);
  std::vector<double> edges = options.bands;
  if (edges.empty() && tolerance) edges = default_bands(*tolerance, map.sign.method != SignMethod::none);
  if (!edges.empty()) {
    result.bands =
        distance_bands(surface, map, edges, {.accuracy = accuracy, .centre = centre_of(tolerance)});
  }
  result.parts = part_tables(surface, map, options, accuracy);
  return result;
}

}  // namespace summary

std::vector<double> default_bands(const Tolerance& tolerance, bool is_signed) {
  const auto [lo, hi] = tolerance;
  std::vector<double> edges;
  if (std::isinf(lo) || std::isinf(hi)) {
    if (const double limit = std::isinf(lo) ? hi : lo; std::isfinite(limit))
      edges = summary::edges_around(limit);
  } else if (lo <= 0 && hi >= 0)
    edges = {2 * lo, lo, lo / 2, hi / 2, hi, 2 * hi};
  else
    edges = {2 * lo - hi, lo, (lo + hi) / 2, hi, 2 * hi - lo};
  const auto omitted = [&](double edge) { return !is_signed && edge <= 0; };
  std::erase_if(edges, omitted);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace sdm
