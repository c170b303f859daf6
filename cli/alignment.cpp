#include "alignment.h"

#include <sdm/align.h>
#include <sdm/doubts.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>
#include <sdm/sites.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "format.h"
#include "src/core/stopwatch.h"
#include "src/io/json/report_json.h"

using Json = nlohmann::ordered_json;

namespace {

double length(const sdm::Vec3& v) {
  return std::hypot(v[0], v[1], v[2]);
}

/// The functions of the library, for a mesh or for points.
struct AlignCalls {
  std::function<sdm::Alignment(const sdm::AlignOptions&)> align;
  std::function<std::optional<sdm::OtherUnit>(const sdm::Alignment&, const sdm::AlignOptions&)> other_unit;
  std::function<std::optional<sdm::MirroredFit>(const sdm::Alignment&)> mirrored;
  std::function<std::optional<sdm::OtherScale>(const sdm::Alignment&)> scale;
};

/// The names that residuals are grouped by: the first kind of the file.
const sdm::FaceNames* groups_of(const Input& o2) {
  return o2.names.empty() ? nullptr : &o2.names.front();
}

sdm::AlignOptions options_of(const AlignCommand& command, const Input& o2, const sdm::Progress& progress) {
  sdm::AlignOptions options{.freedoms = command.freedoms, .region = region_of(command, o2)};
  options.progress = progress;
  if (const sdm::FaceNames* names = groups_of(o2)) options.group_of_face = names->of_face;
  if (!command.points_321.empty()) {
    options.pose = read_321(command.points_321);
    options.freedoms = {.translations = {}, .rotations = {}};
  } else if (command.from == "pca") {
    options.start = sdm::AlignStart::principal_axes;
  } else if (command.from != "auto") {
    options.start = sdm::AlignStart::pose;
    if (command.from != "none") options.pose = sdm::read_matrix(command.from);
  }
  return options;
}

AlignOutcome timed(const Input& o2, const AlignCommand& command, const sdm::Progress& progress,
                   const AlignCalls& calls) {
  sdm::Stopwatch watch;
  const sdm::AlignOptions options = options_of(command, o2, progress);
  try {
    AlignOutcome outcome{calls.align(options), command, size_of(sdm::bounds(o2.mesh))};
    outcome.settings = sdm::settings_json(options, options.freedoms);
    if (command.judged) outcome.other_unit = calls.other_unit(outcome.alignment, options);
    outcome.mirrored = calls.mirrored(outcome.alignment);
    if (options.region.whole() && !outcome.other_unit && !outcome.mirrored)
      outcome.scale = calls.scale(outcome.alignment);
    if (const sdm::FaceNames* names = groups_of(o2); names && names->names.size() > 1) {
      outcome.group_kind = names->kind;
      outcome.group_names = names->names;
    }
    outcome.time_ms = watch.lap();
    return outcome;
  } catch (const sdm::Cancelled&) {
    throw;
  } catch (const sdm::Error& error) {
    if (command.from == "auto" || command.from == "none" || command.from == "pca") throw;
    throw sdm::Error(command.from + ": " + error.what());
  }
}

// A direction in words: its sign does not matter.
std::string direction(sdm::Vec3 v) {
  const auto largest = std::ranges::max_element(v, {}, [](double x) { return std::abs(x); });
  const double scale = (*largest < 0 ? -1 : 1) / length(v);
  for (double& x : v) {
    x = std::round(1e4 * scale * x) / 1e4;
    if (x == 0) x = 0;  // not -0
  }
  return fmt::format("({} {} {})", number(v[0]), number(v[1]), number(v[2]));
}

std::string in_words(const sdm::DegreeOfFreedom& freedom, double size) {
  constexpr double kSlight = 0.05;
  if (!freedom.axis_point || length(freedom.rotation) < kSlight)
    return "translation along " + direction(freedom.translation);
  return fmt::format("rotation about {} through {}", direction(freedom.rotation),
                     place(*freedom.axis_point, size));
}

}  // namespace

AlignOutcome align_mesh(sdm::Mesh& o1, const sdm::Sites& sites, const Input& o2, const AlignCommand& command,
                        const sdm::Progress& progress) {
  AlignOutcome outcome =
      timed(o2, command, progress,
            {[&](const sdm::AlignOptions& options) { return sdm::align(o1, sites, options); },
             [&](const sdm::Alignment& found, const sdm::AlignOptions& options) {
               return sdm::find_other_unit(o1, sites, found, options);
             },
             [&](const sdm::Alignment& found) { return sdm::find_mirrored(o1, sites, found); },
             [&](const sdm::Alignment& found) { return sdm::find_scale(o1, sites, found); }});
  sdm::transform(o1, outcome.alignment.transform);
  return outcome;
}

AlignOutcome align_points(std::span<const sdm::Vec3> points, std::span<const sdm::Vec3> normals,
                          const sdm::Sites& sites, const Input& o2, const AlignCommand& command,
                          const sdm::Progress& progress) {
  return timed(
      o2, command, progress,
      {[&](const sdm::AlignOptions& options) { return sdm::align(points, normals, sites, options); },
       [&](const sdm::Alignment& found, const sdm::AlignOptions& options) {
         return sdm::find_other_unit(points, normals, sites, found, options);
       },
       [&](const sdm::Alignment& found) { return sdm::find_mirrored(points, normals, sites, found); },
       [&](const sdm::Alignment& found) { return sdm::find_scale(points, normals, sites, found); }});
}

std::vector<sdm::Doubt> doubts_of(const AlignOutcome& outcome) {
  return sdm::doubts_of(outcome.alignment, outcome.other_unit, outcome.mirrored);
}

namespace {

/// Residuals of the groups that have any, those with the largest rms first.
std::vector<std::pair<std::string, sdm::GroupResiduals>> named_residuals(const AlignOutcome& outcome) {
  std::vector<std::pair<std::string, sdm::GroupResiduals>> result;
  const std::vector<sdm::GroupResiduals>& groups = outcome.alignment.groups;
  for (std::size_t i = 0; i < std::min(groups.size(), outcome.group_names.size()); ++i)
    if (groups[i].samples > 0) result.emplace_back(outcome.group_names[i], groups[i]);
  std::ranges::stable_sort(result, std::greater(), [](const auto& group) { return group.second.rms; });
  return result;
}

/// What was aligned to what, by which motions, and what else fits.
void add_choices(Json& json, const AlignOutcome& outcome) {
  const AlignCommand& command = outcome.command;
  const bool by_points = !command.points_321.empty();
  json["from"] = by_points ? "321" : command.from;
  json["points"] = by_points ? Json(command.points_321) : Json();
  json["on"] = command.region;
  json["allowed"] = by_points ? std::vector<std::string>() : names_of(command.freedoms);
  json["about"] = command.freedoms.about;
  json["mirrored"] = sdm::value_json(outcome.mirrored);
  json["scale"] = sdm::value_json(outcome.scale);
  json["group_kind"] = outcome.group_kind;
  json["groups"] = Json::array();
  for (const auto& [name, group] : named_residuals(outcome)) {
    json["groups"].push_back({{"name", name}});
    json["groups"].back().update(sdm::fields_json(group));
  }
}

}  // namespace

namespace {

/// Names, which may be several words, in quotation marks if there are several of them.
std::string names_in_words(const std::vector<std::string>& names) {
  return names.size() == 1 ? names[0] : fmt::format("\"{}\"", fmt::join(names, "\", \""));
}

/// What was done, in clauses.
std::vector<std::string> in_words(const AlignOutcome& outcome, const std::string& units) {
  const sdm::Alignment& a = outcome.alignment;
  const std::string unit = unit_suffix(units);
  const auto [degrees, shift] = sdm::motion_of(a);
  const auto rms = [](double value) { return std::isnan(value) ? "unknown" : number(value, 3); };
  std::vector<std::string> words{
      fmt::format("turned O1 by {}° and moved it by {}{}; residual rms {} -> {}{} ({} % of samples)",
                  number(degrees, 4), number(shift, 4), unit, rms(a.before.trimmed_rms),
                  rms(a.after.trimmed_rms), unit, number(100 * a.fraction_used, 4))};
  const AlignCommand& command = outcome.command;
  if (!command.points_321.empty()) words.push_back("by the six points of " + command.points_321);
  if (!command.region.empty())
    words.push_back(fmt::format("on {} ({} samples)", names_in_words(command.region), a.samples));
  if (!command.freedoms.all())
    words.push_back(
        fmt::format("by {} only; the rest is locked", fmt::join(names_of(command.freedoms), ", ")));
  return words;
}

}  // namespace

Json to_json(const AlignOutcome& outcome, const std::string& units) {
  Json json = sdm::to_json(outcome.alignment);
  add_choices(json, outcome);
  json["settings"] = outcome.settings;
  json["text"] = fmt::format("{}", fmt::join(in_words(outcome, units), ", "));
  json["time_ms"] = outcome.time_ms;
  return json;
}

std::string summary(const AlignOutcome& outcome, const std::string& units) {
  std::string text;
  for (const std::string& words : in_words(outcome, units))
    text += (text.empty() ? "  aligned   " : "            ") + words + "\n";
  constexpr std::size_t kShown = 8;
  const auto groups = named_residuals(outcome);
  for (std::size_t i = 0; i < std::min(groups.size(), kShown); ++i)
    text += fmt::format("            {} {}: residual rms {}, largest {}{} (of samples)\n", outcome.group_kind,
                        groups[i].first, number(groups[i].second.rms, 3), number(groups[i].second.largest, 3),
                        unit_suffix(units));
  if (groups.size() > kShown)
    text += fmt::format("            and {} more with smaller residuals\n", groups.size() - kShown);
  return text;
}

std::vector<std::string> notes(const AlignOutcome& outcome) {
  constexpr double kLarge = 0.005, kMany = 0.9;
  const sdm::Alignment& a = outcome.alignment;
  std::vector<std::string> notes;
  if (!a.converged)
    notes.push_back(
        fmt::format("the alignment did not converge in {} steps; its matrix is approximate", a.iterations));
  const bool placed =
      outcome.command.from == "auto" || outcome.command.from == "pca" || !outcome.command.points_321.empty();
  const char* question =
      placed ? "is O1 the same part as O2?" : "is O1 the same part as O2, or does it need --align-from pca?";
  if (a.after.trimmed_rms > kLarge * outcome.size)
    notes.push_back(fmt::format("the aligned surfaces are {} % of the size apart; {}",
                                number(100 * a.after.trimmed_rms / outcome.size, 2), question));
  else if (a.fraction_fitting < kMany)
    notes.push_back(fmt::format("{} % of the samples do not fit O2 and were taken for outliers; {}",
                                number(100 * (1 - a.fraction_fitting), 3), question));
  if (!outcome.command.judged)  // otherwise it is a doubt
    for (const sdm::Doubt& doubt : doubts_of(outcome))
      if (doubt.reason == sdm::DoubtReason::mirrored) notes.push_back(doubt.text);
  if (const auto& s = outcome.scale)
    notes.push_back(fmt::format(
        "O1 fits O2 better {} (standard error {}) times as large: residual rms {} instead of {}, estimates",
        number(s->factor, 6), number(s->standard_error, 2), number(s->residual, 3),
        number(s->residual_as_given, 3)));
  std::string free;
  for (const sdm::DegreeOfFreedom& f : a.freedoms)
    if (f.free) free += (free.empty() ? "" : ", ") + in_words(f, outcome.size);
  if (!free.empty())
    notes.push_back("the surfaces do not determine the alignment; after these motions O1 fits as well: " +
                    free);
  return notes;
}
