#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/sampling_bound.h>
#include <sdm/summary.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "map/measures/walls.h"
#include "map/statistics/texel_areas.h"
#include "summary/distribution.h"
#include "summary/largest_distance.h"
#include "summary/wall_note.h"

namespace sdm {
namespace {

DistanceStatistics statistics_of(const Surface& surface, const DistanceMap& map,
                                 const SummaryOptions& options) {
  return options.distance ? *options.distance : statistics(surface, map);
}

ColorRange colors_of(const SummaryOptions& options, const DistanceStatistics& distance) {
  if (options.colors) {
    if (options.colormap != Colormap::automatic || options.range)
      throw Error("colors excludes colormap and range");
    return *options.colors;
  }
  return color_range({.colormap = options.colormap,
                      .range = options.range,
                      .tolerance = options.tolerance,
                      .accuracy = std::isfinite(options.accuracy) ? options.accuracy : 0},
                     distance);
}

std::size_t boundary_texels(const Sites& sites, const DistanceMap& map, std::span<const std::uint8_t> known) {
  if (sites.closed()) return 0;
  const auto count = [](std::span<const std::uint8_t> mask) {
    return static_cast<std::size_t>(std::ranges::count(mask, 1));
  };
  return known.empty() ? count(boundary_mask(sites, map)) : count(known);
}

/// `walls`: of thickness::wall_lengths().
std::vector<std::string> notes_of(const Surface& surface, const Sites& sites, const Summary& summary,
                                  std::span<const double> walls, const SummaryOptions& options) {
  const Mesh& whole = options.whole ? *options.whole : surface.mesh();
  std::vector<std::string> notes = notes_on(bounds(whole), bounds(sites.mesh()));
  if (summary.distance.texels == 0 && summary.without_match > 0)
    notes.emplace_back("no face of O2 faces as the surface does; are both oriented outwards?");
  else if (summary.distance.texels == 0)
    notes.emplace_back("no texel is within the maximum distance; the map is empty");
  if (summary.measured.facing && summary.measured.kind == DistanceKind::facing)
    if (auto note = note_on_directions(surface.mesh(), *summary.measured.facing, options.units))
      notes.push_back(std::move(*note));
  if (const std::size_t texels = surface.overlapping_texels(); texels > 0)
    notes.push_back(std::to_string(texels) +
                    " texels are covered by several faces, and have the value of one of them");
  if (const std::size_t faces = surface.faces_without_uv_area(); faces > 0)
    notes.push_back(std::to_string(faces) + (faces == 1 ? " face has" : " faces have") +
                    " an area on the surface but none in its UVs: one sample each, and no texel");
  if (may_cross_walls(summary.measured.kind))
    if (auto note =
            summary::note_on_walls(walls, options.tolerance, names_of_part(options.names, options.whole_face),
                                   options.table, options.units))
      notes.push_back(std::move(*note));
  return notes;
}

/// The share of the area whose texels are beyond the maximum distance, and not without a match.
double beyond_fraction(const Surface& surface, const DistanceMap& map) {
  if (map.beyond_max_distance == 0) return 0;
  if (map.without_match == 0) return area_fraction_beyond(surface, map, kInfinity);
  DistanceMap matched;
  matched.distance = map.distance;
  matched.without_texel = map.without_texel;
  for (std::size_t texel = 0; texel < map.unmatched.size(); ++texel)
    if (map.unmatched[texel] != 0) matched.distance[texel] = 0;
  return area_fraction_beyond(surface, matched, kInfinity);
}

/// The guard band of verdicts.
double guard_of(const SummaryOptions& options) {
  return options.guard + options.uncertainty;
}

/// Throws sdm::Error where places cannot decide although they were asked to.
void check_places(const SummaryOptions& options, bool to_another_mesh) {
  if (!options.fail_area && !options.fail_share) return;
  if (!to_another_mesh) throw Error("fail_area and fail_share are for distances to another mesh");
  if (!options.tolerance) throw Error("fail_area and fail_share need a tolerance");
  if (options.fail_area && options.fail_share) throw Error("fail_area excludes fail_share");
}

/// The area that a place needs for a failure; a share is one of the whole mesh.
std::optional<double> fail_area_of(const Surface& surface, const SummaryOptions& options) {
  if (!options.fail_share) return options.fail_area;
  return *options.fail_share * map::surface_area(options.whole ? *options.whole : surface.mesh());
}

Places places_of(const Surface& surface, const DistanceMap& map, std::span<const float> vertex_distances,
                 const DistanceStatistics& distance, const SummaryOptions& options) {
  const std::vector<FaceNames> names = names_of_part(options.names, options.whole_face);
  return find_places(surface, map, vertex_distances,
                     {.tolerance = options.tolerance,
                      .table = options.table,
                      .accuracy = std::isfinite(options.accuracy) ? options.accuracy + guard_of(options) : 0,
                      .p99_abs = distance.p99_abs,
                      .names = names});
}

}  // namespace

const Extreme& farthest(const Extremes& extremes) {
  return -extremes.min.distance > extremes.max.distance ? extremes.min : extremes.max;
}

namespace summary {

LargestDistance largest_distance(const Summary& summary) {
  const Evidence& evidence = summary.evidence;
  LargestDistance result;
  // Distances to other points than the closest one bound nothing.
  if (!std::isfinite(evidence.accuracy) || evidence.samples_only) return result;
  if (summary.beyond_max_distance > 0) {  // somewhere, and not known by how much
    result.lower = std::max(0.0, summary.max_distance - evidence.accuracy);
    return result;
  }
  const Extreme most = summary.extremes ? farthest(*summary.extremes) : Extreme{};
  const double largest = std::abs(most.distance);
  result.lower = std::max(0.0, largest - evidence.accuracy);
  result.upper = largest + evidence.error_bound + evidence.accuracy;
  result.point = most.point;
  return result;
}

}  // namespace summary

Summary summarize(const Surface& surface, const Sites& sites, const DistanceMap& map,
                  std::span<const float> vertex_distances, const SummaryOptions& options) {
  check_places(options, true);
  // What may throw comes first: built by GCC 12, members were destroyed twice where a later initializer
  // threw.
  const DistanceStatistics distance = statistics_of(surface, map, options);
  const std::optional<Extremes> extreme = extremes(surface, map, vertex_distances);
  Summary result{.units = options.units,
                 .sign = map.sign,
                 .measured = map.measured,
                 .distance = distance,
                 .extremes = extreme,
                 .beyond_max_distance = map.beyond_max_distance,
                 .without_match = map.without_match,
                 .max_distance = options.max_distance};
  result.colors = colors_of(options, result.distance);
  double error_bound = 0;
  std::vector<double> wall_lengths;
  run_concurrently(
      {[&] { error_bound = covering_radius(surface); },
       [&] { result.boundary_texels = boundary_texels(sites, map, options.boundary); },
       [&] { result.places = places_of(surface, map, vertex_distances, result.distance, options); },
       [&] { result.beyond_fraction = beyond_fraction(surface, map); },
       [&] {
         if (may_cross_walls(map.measured.kind)) wall_lengths = thickness::wall_lengths(sites);
       },
       [&] { result.distribution = summary::distribution_of(surface, map, result.distance, options); }});
  const double walls = thickness::thin_walls(wall_lengths);
  result.evidence = evidence_of(surface, map, vertex_distances, error_bound, options.accuracy);
  result.evidence.guard = guard_of(options);
  result.evidence.uncertainty = options.uncertainty;
  result.evidence.thin_walls = walls;
  result.hausdorff = summary::largest_distance(result);
  if (options.tolerance)
    result.tolerance = certify_tolerance(surface, sites, map, vertex_distances, *options.tolerance,
                                         {.error_bound = error_bound,
                                          .accuracy = options.accuracy,
                                          .guard = options.guard,
                                          .uncertainty = options.uncertainty,
                                          .thin_walls = walls,
                                          .accept_doubts = options.accept_doubts,
                                          .fail_area = fail_area_of(surface, options),
                                          .progress = options.progress});
  result.coverage = options.coverage;
  result.doubts = options.doubts;
  if (result.tolerance)
    if (auto doubt = doubt_of(*result.tolerance)) result.doubts.push_back(std::move(*doubt));
  withhold_pass(result, options.accept_doubts);
  result.notes = notes_of(surface, sites, result, wall_lengths, options);
  return result;
}

Summary summarize_thickness(const Surface& surface, const DistanceMap& map, const SummaryOptions& options) {
  const std::vector<float> unknown(surface.mesh().positions.size(), std::numeric_limits<float>::quiet_NaN());
  Summary result = summarize_self(surface, map, options);
  result.of_thickness = true;
  result.measured = map.measured;
  result.places.reset();
  result.extremes = extremes(surface, map, unknown);
  result.distribution = summary::distribution_of(surface, map, result.distance, options);
  Evidence& evidence = result.evidence;
  evidence = {.complete = map.beyond_max_distance == 0,
              .samples_only = true,
              .accuracy = options.accuracy,
              .guard = guard_of(options),
              .uncertainty = options.uncertainty,
              .error_bound = kInfinity,
              .is_signed = false};
  if (result.extremes) {
    evidence.lowest = result.extremes->min.distance;
    evidence.highest = result.extremes->max.distance;
  }
  if (!options.tolerance) return result;
  CertifiedVerdict& verdict = result.tolerance.emplace();
  static_cast<Judgement&>(verdict) = judge(evidence, *options.tolerance);
  verdict.tolerance = *options.tolerance;
  verdict.shares = tolerance_shares(surface, map, *options.tolerance, options.accuracy + guard_of(options));
  verdict.exceeded_area_fraction = verdict.shares.below + verdict.shares.above + verdict.shares.without_value;
  if (evidence.complete) verdict.largest = evidence.highest;
  return result;
}

Summary summarize_self(const Surface& surface, const DistanceMap& map, const SummaryOptions& options) {
  check_places(options, false);
  const DistanceStatistics distance = statistics_of(surface, map, options);  // first, as in summarize()
  Summary result{.units = options.units,
                 .of_itself = true,
                 .sign = map.sign,
                 .measured = map.measured,
                 .distance = distance,
                 .beyond_max_distance = map.beyond_max_distance,
                 .max_distance = options.max_distance};
  result.colors = colors_of(options, result.distance);
  result.places = places_of(surface, map, {}, result.distance, options);
  return result;
}

}  // namespace sdm
