#include "points_report.h"

#include <algorithm>

#include "format.h"
#include "notes.h"
#include "places.h"
#include "src/io/json/report_json.h"

namespace {

using Json = nlohmann::ordered_json;

// How text was read, unless that is the plain way: x, y and z first, between blanks.
std::string text_summary(const sdm::TextDialect& text) {
  const bool blank = text.separator == sdm::TextSeparator::blank || text.separator == sdm::TextSeparator::tab;
  const auto& c = text.columns;
  const bool plain = blank && text.decimal == sdm::DecimalMark::point && c[0] == "x" && c[1] == "y" &&
                     c[2] == "z" &&
                     std::ranges::all_of(c.begin() + 3, c.end(), [](auto& name) { return name == "_"; });
  if (plain) return {};
  return fmt::format("  text      separator {}, decimal {}, columns {}{}\n", sdm::name_of(text.separator),
                     sdm::name_of(text.decimal), fmt::join(c, ","),
                     text.header_line ? fmt::format(", header in line {}", *text.header_line) : "");
}

/// The share of the points with coordinates.
double without_value(const sdm::PointDistances& found) {
  return static_cast<double>(found.beyond_max_distance + found.without_match) /
         static_cast<double>(std::max<std::uint64_t>(found.counted(), 1));
}

std::string tolerance_line(const PointsOutcome& outcome, const std::string& unit) {
  const sdm::Summary& summary = outcome.summary;
  const sdm::CertifiedVerdict& verdict = *summary.tolerance;
  const std::string word = sdm::name_of(verdict.verdict);
  if (verdict.verdict != sdm::Verdict::fail) return word + ": " + sdm::verdict_text(summary);
  if (verdict.by_facing.value_or(false)) {
    const sdm::Evidence& facing = *outcome.found.by_facing;
    const auto& most = verdict.nearest_is_lower ? facing.lowest : facing.highest;
    return fmt::format("{}: {}{}", word, sdm::verdict_text(summary),
                       verdict.reason == sdm::VerdictReason::exceeded
                           ? fmt::format(": {}{}", number(*most), unit)
                           : std::string());
  }
  if (verdict.reason == sdm::VerdictReason::without_match ||
      verdict.reason == sdm::VerdictReason::beyond_max_distance)
    return fmt::format("{}: {} % of the points have no value, as {}", word,
                       number(100 * without_value(outcome.found)), sdm::verdict_text(summary));
  const std::string share = fmt::format("{}: {} % of the points are out of it{}", word,
                                        number(100 * summary.exceeding_point_fraction),
                                        sdm::uncertainty_text(summary.evidence.uncertainty, summary.units));
  const std::optional<sdm::Extreme> most = decisive_extreme(summary);
  if (!most) return share + "; no point has a value";
  return fmt::format("{}; {}{} at point {} {}", share, number(most->distance), unit,
                     summary.extreme_points[verdict.nearest_is_lower ? 0 : 1],
                     place(most->point, size_of(outcome.found.bounds)));
}

}  // namespace

nlohmann::ordered_json report_of(const PointsCommand& command, const Input& o2,
                                 const PointsOutcome& outcome) {
  const sdm::PointDistances& found = outcome.found;
  Json report;
  report["version"] = sdm::kVersion;
  report["o1"] = {
      {"file", command.cloud},  {"xxh3", sdm::file_xxh3(command.cloud)}, {"transform", command.transform_o1},
      {"points", found.points}, {"invalid_points", found.invalid},       {"normals", found.has_normals}};
  if (found.islands) report["o1"]["ignored_islands"] = to_json(*found.islands, found.points);
  report["o1"]["format"] = found.format;
  report["o1"]["text"] = sdm::value_json(found.text);
  report["o2"] = to_json(o2);
  if (o2.islands) report["o2"]["ignored_islands"] = to_json(*o2.islands);
  report["measured_on"] = "o1";
  if (outcome.aligned) report["alignment"] = to_json(*outcome.aligned, command.picture.units);
  report["engine"] = "cpu";
  report.update(sdm::to_json(outcome.summary));
  if (found.groups) report["group_tolerances"] = groups_json(*found.groups, outcome.summary);
  put_fields(report, command.fields);
  report["time_ms"] = {
      {"import", outcome.import_ms}, {"align", outcome.align_ms}, {"points", outcome.points_ms}};
  return report;
}

std::string text_of(const PointsCommand& command, const PointsOutcome& outcome) {
  const sdm::PointDistances& found = outcome.found;
  const sdm::Summary& s = outcome.summary;
  const sdm::DistanceStatistics& d = s.distance;
  const std::string unit = unit_suffix(s.units);
  std::string text = heading(fmt::format("{} -> {}", command.cloud, command.o2), judged(s, found.groups));
  if (outcome.aligned) text += summary(*outcome.aligned, s.units);
  if (found.text) text += text_summary(*found.text);
  text += fmt::format("  points    {}\n", found.points) + measured_line(s);
  if (found.invalid > 0) text += fmt::format("            {} without coordinates\n", found.invalid);
  if (d.texels == 0) {
    text += "  distance  no point has a value\n";
  } else {
    text += fmt::format("  distance  min {}   mean {}   max {}{}\n", number(d.min), number(d.mean),
                        number(d.max), unit);
    if (s.sign.method != sdm::SignMethod::none)
      text += fmt::format("            {} % of the points are {} (negative)\n",
                          number(100 * d.negative_area_fraction), side_word(s.sign));
  }
  if (s.sign.method == sdm::SignMethod::none)
    text += fmt::format("            unsigned: {}\n", s.sign.reason);
  if (s.beyond_max_distance > 0)
    text += fmt::format("            {} points, {} % of them, are farther than --max-distance\n",
                        s.beyond_max_distance, number(100 * s.beyond_fraction));
  if (s.without_match > 0)
    text += fmt::format("            {} points have no face {}\n", s.without_match,
                        s.measured.kind == sdm::DistanceKind::along ? "on their line that faces the same way"
                                                                    : "that faces them");
  if (sdm::lacks_boundary_signs(s.measured.kind, s.sign.method))
    text += "            signs are estimates; points closest to the boundary of O2 have none: |d|\n";
  if (s.tolerance) text += fmt::format("  tolerance {}\n", tolerance_line(outcome, unit));
  text += place_lines(s, size_of(found.bounds));
  if (found.groups) text += group_lines(*found.groups, s);
  return text + coverage_line(s) + doubt_lines(s.doubts, 12) + note_lines(s.notes, 12);
}
