#include <sdm/summary.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/vec.h"
#include "summary/largest_distance.h"

namespace sdm {
namespace {

double area_of(const Surface& surface) {
  std::vector<std::size_t> texels(surface.mesh().triangles.size());
  for (const std::uint32_t face : surface.texel_faces())
    if (face != kNone) ++texels[face];
  double area = 0;
  for (std::uint32_t face = 0; face < texels.size(); ++face) {
    if (texels[face] == 0) continue;
    const auto [u, v] = surface.texel_edges(face);
    area += static_cast<double>(texels[face]) * norm(cross(u, v));
  }
  return area;
}

void extend(Extremes& all, const Extremes& more) {
  const auto replace = [](Extreme& most, const Extreme& other, bool farther) {
    if (std::isnan(most.distance) || farther) most = other;
  };
  replace(all.min, more.min, more.min.distance < all.min.distance);
  replace(all.max, more.max, more.max.distance > all.max.distance);
}

void extend(Evidence& all, const Evidence& more) {
  all.lowest = std::min(all.lowest, more.lowest), all.highest = std::max(all.highest, more.highest);
  all.complete = all.complete && more.complete;
  all.estimated_signs = all.estimated_signs || more.estimated_signs;
  all.accuracy = std::max(all.accuracy, more.accuracy);
  all.error_bound = std::max(all.error_bound, more.error_bound);
}

/// The verdict of one of the maps decides: of the first that fails, else of the one that is farthest from
/// being decided, else of the one with the least margin.
const CertifiedVerdict& decisive(std::span<const CertifiedVerdict> verdicts) {
  const auto rank = [](const CertifiedVerdict& v) {
    const double least = v.verdict == Verdict::not_decided ? v.deciding_bound : v.margin;
    return std::pair(v.verdict == Verdict::fail          ? 0
                     : v.verdict == Verdict::not_decided ? 1
                     : v.verdict == Verdict::doubtful    ? 2
                                                         : 3,
                     v.verdict == Verdict::fail ? (v.certified ? 0.0 : 1.0) : least);
  };
  return *std::ranges::min_element(verdicts, {}, rank);
}

CertifiedVerdict combined(std::span<const CertifiedVerdict> verdicts, std::span<const double> areas) {
  CertifiedVerdict total = decisive(verdicts);
  total.shares = {}, total.largest = 0;
  double area = 0;
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    const CertifiedVerdict& v = verdicts[i];
    total.largest = std::max(total.largest, v.largest);
    total.margin = std::min(total.margin, v.margin);
    area += areas[i];
    total.shares.below += areas[i] * v.shares.below;
    total.shares.within += areas[i] * v.shares.within;
    total.shares.above += areas[i] * v.shares.above;
    total.shares.without_value += areas[i] * v.shares.without_value;
  }
  if (area > 0)
    for (double* share :
         {&total.shares.below, &total.shares.within, &total.shares.above, &total.shares.without_value})
      *share /= area;
  total.exceeded_area_fraction = total.shares.below + total.shares.above + total.shares.without_value;
  return total;
}

}  // namespace

void CombinedSummary::add(const Surface& surface, const DistanceMap& map, const Summary& summary) {
  statistics_.add(surface, map);
  const bool first = areas_.empty();
  areas_.push_back(area_of(surface));
  if (summary.tolerance) verdicts_.push_back(*summary.tolerance);
  if (first) {
    total_ = summary;
    total_.distribution.reset(), total_.colors.reset(), total_.notes.clear();
    return;
  }
  extend(total_.extremes, summary.extremes);
  extend(total_.evidence, summary.evidence);
  total_.beyond_max_distance += summary.beyond_max_distance;
  total_.boundary_texels += summary.boundary_texels;
}

Summary CombinedSummary::summary() const {
  Summary total = total_;
  total.distance = statistics_.statistics();
  total.hausdorff = summary::largest_distance(total);
  if (!verdicts_.empty()) {
    total.tolerance = combined(verdicts_, areas_);
    if (!total.tolerance->proof)
      total.tolerance->nearest_is_lower = judge(total.evidence, total.tolerance->tolerance).nearest_is_lower;
  }
  return total;
}

}  // namespace sdm
