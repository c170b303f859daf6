#include <sdm/summary.h>
#include <sdm/tolerance.h>
#include <sdm/verdict.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "map/statistics/texel_areas.h"
#include "summary/largest_distance.h"
#include "summary/verdict/group_rows.h"

namespace sdm {
namespace {

double area_of(const Surface& surface) {
  const std::vector<std::uint32_t>& samples = internals(surface).face_samples;
  double area = 0;
  for (std::uint32_t face = 0; face < samples.size(); ++face)
    if (samples[face] > 0) area += map::face_area(surface.mesh(), face);
  return area;
}

void extend(std::optional<Extremes>& all, const std::optional<Extremes>& more) {
  if (!all) {
    all = more;
  } else if (more) {
    if (more->min.distance < all->min.distance) all->min = more->min;
    if (more->max.distance > all->max.distance) all->max = more->max;
  }
}

void extend(Evidence& all, const Evidence& more) {
  if (more.lowest) {
    all.lowest = std::min(all.lowest.value_or(*more.lowest), *more.lowest);
    all.highest = std::max(all.highest.value_or(*more.highest), *more.highest);
  }
  all.complete = all.complete && more.complete;
  all.unmatched = all.unmatched || more.unmatched;
  all.samples_only = all.samples_only || more.samples_only;
  all.estimated_signs = all.estimated_signs || more.estimated_signs;
  all.accuracy = std::max(all.accuracy, more.accuracy);
  all.error_bound = std::max(all.error_bound, more.error_bound);
  all.guard = std::max(all.guard, more.guard);
  all.uncertainty = std::max(all.uncertainty, more.uncertainty);
  all.thin_walls = std::min(all.thin_walls, more.thin_walls);
}

/// The margin of a map among others: a map without samples has no limit, one of which a sample has no value
/// is worse than all others.
double comparable_margin(const ToleranceVerdict& v) {
  return v.margin.value_or(v.reason == VerdictReason::nothing_measured ? kInfinity : -kInfinity);
}

/// The verdict of one of the maps decides: of the first that fails, else of the one that is farthest from
/// being decided, else of the one with the least margin.
const CertifiedVerdict& decisive(std::span<const CertifiedVerdict> verdicts) {
  const auto rank = [](const CertifiedVerdict& v) {
    const double least =
        v.verdict == Verdict::not_decided ? v.deciding_bound.value_or(0) : comparable_margin(v);
    return std::pair(v.verdict == Verdict::fail          ? 0
                     : v.verdict == Verdict::not_decided ? 1
                     : v.verdict == Verdict::doubtful    ? 2
                                                         : 3,
                     v.verdict == Verdict::fail ? (v.certified ? 0.0 : 1.0) : least);
  };
  return *std::ranges::min_element(verdicts, {}, rank);
}

// That of one of the maps, which have these areas, with the shares and the margin of all. There is one.
CertifiedVerdict combined_verdict(std::span<const CertifiedVerdict> verdicts, std::span<const double> areas) {
  CertifiedVerdict total = decisive(verdicts);
  total.shares = {};
  total.largest.reset();
  total.margin.reset();
  double area = 0, margin = kInfinity;
  bool complete = true;
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    const CertifiedVerdict& v = verdicts[i];
    if (total.verdict != Verdict::fail) total.certified = total.certified && v.certified;
    complete = complete && (v.largest || v.reason == VerdictReason::nothing_measured);
    if (v.largest) total.largest = std::max(total.largest.value_or(0), *v.largest);
    margin = std::min(margin, comparable_margin(v));
    area += areas[i];
    total.shares.below += areas[i] * v.shares.below;
    total.shares.within += areas[i] * v.shares.within;
    total.shares.above += areas[i] * v.shares.above;
    total.shares.without_value += areas[i] * v.shares.without_value;
  }
  if (!complete) total.largest.reset();
  if (std::isfinite(margin)) total.margin = margin;
  if (area > 0)
    for (double* share :
         {&total.shares.below, &total.shares.within, &total.shares.above, &total.shares.without_value})
      *share /= area;
  total.exceeded_area_fraction = total.shares.below + total.shares.above + total.shares.without_value;
  return total;
}

/// The parts of one group.
GroupVerdict joined(std::span<const GroupVerdict> parts) {
  GroupVerdict all = parts.front();
  std::vector<CertifiedVerdict> verdicts;
  std::vector<double> areas;
  all.faces = 0;
  all.points = 0;
  all.area = 0;
  for (const GroupVerdict& part : parts) {
    all.faces += part.faces;
    all.points += part.points;
    all.area += part.area;
    if (part.lowest) {
      all.lowest = std::min(all.lowest.value_or(*part.lowest), *part.lowest);
      all.highest = std::max(all.highest.value_or(*part.highest), *part.highest);
    }
    verdicts.push_back(part.verdict);
    areas.push_back(part.area);
  }
  all.verdict = combined_verdict(verdicts, areas);
  return all;
}

}  // namespace

GroupVerdicts combined_groups(std::span<const GroupVerdicts> parts, std::span<const GroupTolerance> table,
                              bool doubted) {
  GroupVerdicts result;
  for (const GroupTolerance& row : table) {
    std::vector<GroupVerdict> of_row;
    for (const GroupVerdicts& part : parts)
      std::ranges::copy_if(part.groups, std::back_inserter(of_row), [&](const GroupVerdict& g) {
        return g.group == row.group && g.verdict.tolerance == row.tolerance &&
               (row.kind.empty() || g.kind == row.kind);
      });
    if (!of_row.empty()) result.groups.push_back(joined(of_row));
  }
  result.verdict = summary::worst_of(result.groups, doubted);
  return result;
}

void CombinedSummary::add(const Surface& surface, const DistanceMap& map, const Summary& summary) {
  statistics_.add(surface, map);
  const bool first = areas_.empty();
  areas_.push_back(area_of(surface));
  beyond_.push_back(summary.beyond_fraction);
  if (summary.places) places_.push_back(*summary.places);
  if (summary.tolerance) verdicts_.push_back(*summary.tolerance);
  if (first) {
    total_ = summary;
    total_.distribution.reset();
    total_.colors.reset();
    total_.notes.clear();
    return;
  }
  extend(total_.extremes, summary.extremes);
  extend(total_.evidence, summary.evidence);
  for (const Doubt& doubt : summary.doubts)
    if (std::ranges::find(total_.doubts, doubt.reason, &Doubt::reason) == total_.doubts.end())
      total_.doubts.push_back(doubt);
  total_.beyond_max_distance += summary.beyond_max_distance;
  total_.without_match += summary.without_match;
  total_.boundary_texels += summary.boundary_texels;
}

Summary CombinedSummary::summary() const {
  Summary total = total_;
  total.distance = statistics_.statistics();
  total.hausdorff = summary::largest_distance(total);
  double area = 0, beyond = 0;
  for (std::size_t i = 0; i < areas_.size(); ++i) {
    area += areas_[i];
    beyond += areas_[i] * beyond_[i];
  }
  total.beyond_fraction = area > 0 ? beyond / area : 0;
  total.places.reset();
  if (places_.size() == areas_.size()) total.places = combined_places(places_, areas_);
  if (!verdicts_.empty()) {
    total.tolerance = combined_verdict(verdicts_, areas_);
    if (!total.tolerance->proof)
      total.tolerance->nearest_is_lower = judge(total.evidence, total.tolerance->tolerance).nearest_is_lower;
  }
  return total;
}

}  // namespace sdm
