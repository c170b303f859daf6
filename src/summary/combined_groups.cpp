#include <sdm/tolerance.h>
#include <sdm/verdict.h>

#include <algorithm>
#include <vector>

#include "summary/combined_verdict.h"
#include "summary/verdict/group_rows.h"

namespace sdm {
namespace {

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
  all.verdict = summary::combined_verdict(verdicts, areas);
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

}  // namespace sdm
