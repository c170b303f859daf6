#include <sdm/points.h>

#include <algorithm>
#include <utility>

#include "summary/verdict/certify.h"
#include "summary/verdict/evidence.h"

namespace sdm {

Summary summarize(const PointDistances& found, const PointDistancesOptions& options) {
  PictureOptions picture = options.picture;
  picture.accuracy = found.accuracy;
  const auto counted = static_cast<double>(std::max<std::uint64_t>(found.counted(), 1));
  Summary summary{.units = picture.units,
                  .of_points = true,
                  .sign = found.sign,
                  .measured = found.measured,
                  .distance = found.distance,
                  .beyond_max_distance = found.beyond_max_distance,
                  .beyond_fraction = static_cast<double>(found.beyond_max_distance) / counted,
                  .without_match = found.without_match,
                  .max_distance = options.map.max_distance,
                  .evidence = {.complete = found.beyond_max_distance + found.without_match == 0,
                               .unmatched = found.without_match > 0,
                               .estimated_signs = has_estimated_signs(found.measured.kind, found.sign.method),
                               .accuracy = found.accuracy,
                               .guard = options.guard + options.uncertainty,
                               .uncertainty = options.uncertainty,
                               .is_signed = found.sign.method != SignMethod::none,
                               .thin_walls = found.thin_walls},
                  .places = found.places,
                  .colors = color_range(color_choice(picture), found.distance)};
  if (found.min) {
    summary.extremes = {{found.min->distance, found.min->point}, {found.max->distance, found.max->point}};
    summary.extreme_points = {found.min->index, found.max->index};
    summary.evidence.lowest = found.min->distance;
    summary.evidence.highest = found.max->distance;
  }
  if (found.note_on_walls) summary.notes.push_back(*found.note_on_walls);
  if (!picture.tolerance) return summary;
  Judgement judgement =
      found.sign.method == SignMethod::side
          ? summary::judge_by_side(summary.evidence, *picture.tolerance, found.missing_signs_matter)
          : judge(summary.evidence, *picture.tolerance);
  if (summary::may_lack_signs(judgement, found.measured.kind, found.sign.method) &&
      !found.beyond_with_either_sign)
    summary::withhold_failure(judgement);
  summary.tolerance = CertifiedVerdict{{judgement, *picture.tolerance, {}, 0, {}}};
  summary::decide_thin_walls(*summary.tolerance, found.by_facing, options.accept_doubts);
  if (auto doubt = doubt_of(*summary.tolerance)) summary.doubts.push_back(std::move(*doubt));
  if (found.min && summary.evidence.complete) summary.tolerance->largest = found.distance.max_abs;
  summary.exceeding_points = found.beyond_tolerance;
  summary.exceeding_point_fraction = static_cast<double>(found.beyond_tolerance) / counted;
  return summary;
}

}  // namespace sdm
