#include "io/points/cloud_groups.h"

#include <cmath>
#include <utility>

#include "map/statistics/tolerance_limits.h"

namespace sdm::io {

CloudGroups::CloudGroups(std::span<const FaceNames> names, std::span<const GroupTolerance> table,
                         std::size_t faces, const SignUsed& sign, DistanceKind measured)
    : rows_(names, table, faces),
      row_of_(rows_.layers.size()),
      found_(rows_.rows.size()),
      sign_(sign.method),
      measured_(measured) {
  for (std::size_t r = 0; r < rows_.rows.size(); ++r) {
    row_of_[rows_.rows[r].layer].push_back(r);
    summary::check_sign(rows_.rows[r].group, sign);
  }
}

template <class Visit>
void CloudGroups::for_each_row(std::uint32_t face, const Visit& visit) {
  if (face == kNone) return;
  for (std::size_t l = 0; l < rows_.layers.size(); ++l)
    if (const std::uint32_t number = rows_.layers[l].of_face[face]; number != kNone)
      visit(row_of_[l][number]);
}

void CloudGroups::add(std::uint32_t face, double d, bool has_sign) {
  for_each_row(face, [&](std::size_t r) {
    ++found_[r].points;
    found_[r].range.add(d);
    found_[r].signs.add(d, has_sign);
  });
}

void CloudGroups::add_facing(std::uint32_t face, double d) {
  for_each_row(face, [&](std::size_t r) {
    found_[r].any_facing = true;
    if (std::isnan(d))
      found_[r].unmatched = true;
    else
      found_[r].facing.add(d);
  });
}

void CloudGroups::count(std::uint32_t face, double d, double accuracy) {
  for_each_row(face, [&](std::size_t r) {
    const map::ToleranceLimits limits(rows_.rows[r].group.tolerance, accuracy);
    found_[r].below += limits.below(d);
    found_[r].above += limits.above(d);
  });
}

bool CloudGroups::any_out(double accuracy) const {
  for (std::size_t r = 0; r < found_.size(); ++r) {
    const map::ToleranceLimits limits(rows_.rows[r].group.tolerance, accuracy);
    const auto& [lowest, highest] = std::pair(found_[r].range.lowest, found_[r].range.highest);
    if (lowest && (limits.below(*lowest) || limits.above(*highest))) return true;
  }
  return false;
}

GroupVerdicts CloudGroups::verdicts(const PointsWithoutGroup& without_group, const Evidence& like,
                                    bool accept_doubts) const {
  const double accuracy = like.accuracy + like.guard;
  std::vector<GroupPoints> groups;
  for (std::size_t r = 0; r < found_.size(); ++r) {
    const summary::GroupRows::Row& row = rows_.rows[r];
    const Found& found = found_[r];
    Evidence evidence = like;
    evidence.lowest = found.range.lowest;
    evidence.highest = found.range.highest;
    evidence.estimated_signs = has_estimated_signs(measured_, sign_);
    if (sign_ == SignMethod::side &&
        summary::passes_by_side(evidence, row.group.tolerance,
                                found.signs.missing_signs_matter(row.group.tolerance, accuracy)))
      evidence.estimated_signs = false;
    std::optional<Evidence> by_facing;
    if (found.any_facing) by_facing = facing_evidence(like, found.facing, found.unmatched);
    groups.push_back({.kind = row.named.kind,
                      .row = row.group,
                      .faces = row.named.faces.size(),
                      .points = found.points,
                      .below = found.below,
                      .above = found.above,
                      .out_with_either_sign = found.signs.any_out(row.group.tolerance, accuracy),
                      .evidence = evidence,
                      .by_facing = by_facing});
  }
  return judge_groups(groups, without_group, sign_, measured_, accept_doubts);
}

Evidence facing_evidence(const Evidence& like, const summary::DistanceRange& range, bool unmatched) {
  Evidence evidence = like;
  evidence.lowest = range.lowest;
  evidence.highest = range.highest;
  evidence.complete = !unmatched;
  evidence.unmatched = unmatched;
  evidence.estimated_signs = false;
  evidence.thin_walls = kInfinity;
  return evidence;
}

}  // namespace sdm::io
