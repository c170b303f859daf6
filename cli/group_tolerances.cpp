#include "group_tolerances.h"

#include <sdm/error.h>
#include <sdm/summary.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "format.h"
#include "option_checks.h"
#include "src/io/json/report_json.h"

using Json = nlohmann::ordered_json;

namespace {

// The measured range, and by what a group passes or fails.
std::string group_text(const sdm::GroupVerdict& g, const sdm::Summary& summary) {
  const std::string unit = unit_suffix(summary.units);
  std::string text =
      fmt::format("{} ({}): {}, {}", g.group, g.kind, sdm::name_of(g.verdict.verdict),
                  sdm::limits_text(g.verdict.tolerance, summary.units, summary.evidence.is_signed));
  if (g.lowest) text += fmt::format(", measured {} to {}{}", number(*g.lowest), number(*g.highest), unit);
  if (g.verdict.reason == sdm::VerdictReason::without_match ||
      g.verdict.reason == sdm::VerdictReason::beyond_max_distance ||
      g.verdict.verdict == sdm::Verdict::not_decided)
    text += fmt::format(", {}", sdm::name_of(g.verdict.reason));
  if (g.verdict.verdict == sdm::Verdict::fail)
    text += fmt::format(", {} % of its {} out", number(100 * g.verdict.exceeded_area_fraction),
                        summary.of_points ? "points are" : "area is");
  if (g.verdict.proof && g.verdict.proof->witness)
    text += fmt::format(
        ", {}{} {}", number(g.verdict.proof->witness->distance), unit,
        g.verdict.by_facing.value_or(false) ? "by the faces that face the same way" : "between the texels");
  if (g.verdict.proof && g.verdict.reason == sdm::VerdictReason::without_match)
    text += fmt::format(", of {} faces", g.verdict.proof->faces_without_match);
  if (g.verdict.proof && g.verdict.proof->undecided_by)
    text += fmt::format(", not decided by {}{}", number(*g.verdict.proof->undecided_by), unit);
  return text;
}

// "1 point is" or "7 points are".
std::string points_are(std::uint64_t points) {
  return points == 1 ? "1 point is" : fmt::format("{} points are", points);
}

// Why all groups together fail, whatever the single ones do.
std::string without_group_text(const sdm::PointsWithoutGroup& points, const sdm::Summary& summary) {
  std::vector<std::string> reasons;
  if (points.beyond_max_distance > 0)
    reasons.push_back(fmt::format(
        "{} of no group, as the reference is farther than the maximum distance ({}{})",
        points_are(points.beyond_max_distance), number(summary.max_distance), unit_suffix(summary.units)));
  if (points.without_match > 0)
    reasons.push_back(fmt::format("{} of no group, as no face of the reference faces the same way",
                                  points_are(points.without_match)));
  return fmt::format("{}", fmt::join(reasons, ". "));
}

// The value that is farthest beyond the limits of its group.
std::string worst_text(const sdm::GroupVerdicts& verdicts, const sdm::Summary& summary) {
  std::string text;
  double most = 0;
  const bool is_signed = summary.evidence.is_signed;
  for (const sdm::GroupVerdict& g : verdicts.groups) {
    std::vector<double> values;
    if (g.lowest) values = {*g.lowest, *g.highest};
    if (g.verdict.proof && g.verdict.proof->witness) values.push_back(g.verdict.proof->witness->distance);
    const sdm::Tolerance& limits = g.verdict.tolerance;
    for (const double value : values) {
      const double beyond = std::max(value - limits.upper, limits.lower - value);
      if (!(beyond > most)) continue;
      most = beyond;
      text = fmt::format(". Worst: {}{}{} in {}, for which {} is allowed", is_signed && value > 0 ? "+" : "",
                         number(value), unit_suffix(summary.units), g.group,
                         sdm::limits_text(limits, summary.units, is_signed));
    }
  }
  return text;
}

// The groups that have the verdict of all: "2 of 3 groups ... fail: “a”, “b”".
std::string some_groups_text(const sdm::GroupVerdicts& verdicts, const char* does, const char* do_) {
  constexpr std::size_t kMost = 5;
  std::vector<std::string> names;
  for (const sdm::GroupVerdict& g : verdicts.groups)
    if (g.verdict.verdict == verdicts.verdict) names.push_back(g.group);
  if (names.empty()) return {};
  const std::size_t count = names.size();
  if (count > 1)  // a name may be several words
    for (std::string& name : names) name = fmt::format("“{}”", name);
  names.resize(std::min(count, kMost));
  return fmt::format("{} of {} groups of the table of tolerances {}: {}{}", count, verdicts.groups.size(),
                     count > 1 ? do_ : does, fmt::join(names, ", "), count > kMost ? " and others" : "");
}

// The verdict on all groups in words, which the page shows too.
std::string all_groups_text(const sdm::GroupVerdicts& verdicts, const sdm::Summary& summary) {
  const std::string within = "every group of the table of tolerances is within its limits";
  switch (verdicts.verdict) {
    case sdm::Verdict::pass:
      return within;
    case sdm::Verdict::doubtful: {
      std::vector<std::string> doubts;
      for (const sdm::Doubt& doubt : summary.doubts) doubts.push_back(doubt.text);
      return fmt::format("{}, but {}", within,
                         doubts.empty() ? "in doubt" : fmt::format("{}", fmt::join(doubts, "; ")));
    }
    case sdm::Verdict::not_decided:
      return some_groups_text(verdicts, "is not decided", "are not decided");
    case sdm::Verdict::fail:
      break;
  }
  std::string text = some_groups_text(verdicts, "fails", "fail");
  if (!text.empty()) text += worst_text(verdicts, summary);
  if (!text.empty() && verdicts.without_group.any()) text += ". ";
  return text + without_group_text(verdicts.without_group, summary);
}

}  // namespace

std::string no_group(const std::string& name, const Input& mesh) {
  return fmt::format("no face of {} has the name '{}'; {}", mesh.file, name, sdm::names_text(mesh.names));
}

namespace {

// The sentence names all meshes that could have the group.
std::string no_group_of(const std::string& name, std::span<const Input* const> meshes) {
  if (meshes.size() == 1) return no_group(name, *meshes[0]);
  std::vector<std::string> files, known;
  for (const Input* mesh : meshes) {
    files.push_back(mesh->file);
    known.push_back(fmt::format("of {}, {}", mesh->file, sdm::names_text(mesh->names)));
  }
  return fmt::format("no face of {} has the name '{}'; {}", fmt::join(files, " or "), name,
                     fmt::join(known, "; "));
}

}  // namespace

void add_tolerance_table_option(CLI::App& app, GroupTolerances& table, const std::string& what) {
  app.add_option("--tolerance-table", table.file,
                 what +
                     ": CSV with the header "
                     "group,lower,upper, or with semicolons, or JSON with these keys; an empty limit is "
                     "none. A group is an object, group, material, face or "
                     "color of its file. Faces of no row are judged by --tolerance only")
      ->check(non_empty())
      ->type_name("FILE");
}

void check_groups(const GroupTolerances& table, std::initializer_list<const Input*> meshes) {
  std::vector<bool> known(table.rows.size());
  for (const Input* mesh : meshes) {
    const std::vector<sdm::NamedFaces> named = sdm::faces_of_groups(mesh->names, table.rows);
    for (std::size_t row = 0; row < named.size(); ++row)
      if (!named[row].faces.empty()) known[row] = true;
  }
  for (std::size_t row = 0; row < known.size(); ++row)
    if (!known[row])
      throw sdm::Error(fmt::format("{}: {}", table.file, no_group_of(table.rows[row].group, meshes)));
}

std::optional<std::string> note_on_unjudged(const GroupTolerances& table, const Input& input) {
  std::vector<bool> has_limits(input.mesh.triangles.size());
  for (const sdm::NamedFaces& named : sdm::faces_of_groups(input.names, table.rows))
    for (const std::uint32_t face : named.faces) has_limits[face] = true;
  double all = 0, judged = 0;
  for (std::size_t face = 0; face < has_limits.size(); ++face) {
    const auto& [a, b, c] = input.mesh.triangles[face];
    const std::vector<sdm::Vec3>& p = input.mesh.positions;
    const double area = sdm::norm(sdm::cross(p[b] - p[a], p[c] - p[a]));
    all += area;
    judged += has_limits[face] ? area : 0;
  }
  if (judged == 0 || judged == all) return std::nullopt;
  return fmt::format("{} % of the area of {} has no limits and is not judged",
                     number(100 * (all - judged) / all, 3), input.file);
}

Json groups_json(const sdm::GroupVerdicts& verdicts, const sdm::Summary& summary) {
  Json all{{"verdict", sdm::name_of(verdicts.verdict)}, {"text", all_groups_text(verdicts, summary)}};
  all.update(sdm::to_json(verdicts, summary.of_points));
  return all;
}

std::string group_lines(const sdm::GroupVerdicts& verdicts, const sdm::Summary& summary) {
  std::string text = fmt::format("  groups    {}", sdm::name_of(verdicts.verdict));
  if (verdicts.without_group.any()) text += ": " + without_group_text(verdicts.without_group, summary);
  text += '\n';
  for (const sdm::GroupVerdict& g : verdicts.groups)
    text += fmt::format("            {}\n", group_text(g, summary));
  return text;
}

void add_group_doubts(const sdm::GroupVerdicts& groups, std::vector<sdm::Doubt>& doubts) {
  for (const sdm::GroupVerdict& group : groups.groups)
    if (auto doubt = sdm::doubt_of(group.verdict)) return doubts.push_back(std::move(*doubt));
}
