#include "alignment.h"

#include <sdm/error.h>
#include <sdm/io.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "format.h"
#include "stopwatch.h"

using Json = nlohmann::ordered_json;

namespace {

double length(const sdm::Vec3& v) {
  return std::hypot(v[0], v[1], v[2]);
}

AlignOutcome timed(
    const sdm::Sites& o2, const AlignCommand& command, const sdm::Progress& progress,
    const std::function<sdm::Alignment(const sdm::AlignOptions&)>& align,
    const std::function<std::optional<sdm::OtherUnit>(const sdm::Alignment&, const sdm::AlignOptions&)>&
        find_other_unit) {
  Stopwatch watch;
  sdm::AlignOptions options;
  options.progress = progress;
  if (command.from == "pca")
    options.start = sdm::AlignStart::principal_axes;
  else if (command.from != "none")
    options.pose = sdm::read_matrix(command.from);
  try {
    AlignOutcome outcome{align(options), command.from, size_of(sdm::bounds(o2.mesh()))};
    if (command.judged) outcome.other_unit = find_other_unit(outcome.alignment, options);
    outcome.time_ms = watch.lap();
    return outcome;
  } catch (const sdm::Cancelled&) {
    throw;
  } catch (const sdm::Error& error) {
    if (command.from == "none" || command.from == "pca") throw;
    throw sdm::Error(command.from + ": " + error.what());
  }
}

// The rotation angle in degrees, and how far the centre of O1 moves.
std::pair<double, double> sizes(const sdm::Alignment& a) {
  const auto& r = a.transform.rows;
  // The antisymmetric part is accurate for small angles, unlike the trace alone.
  const double sine = 0.5 * std::hypot(r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]);
  const double angle = std::atan2(sine, 0.5 * (r[0][0] + r[1][1] + r[2][2] - 1));
  sdm::Vec3 before{};  // the inverse of a rotation is its transpose
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) before[i] += r[j][i] * (a.centre[j] - r[j][3]);
  return {angle * 180 / std::numbers::pi,
          length({a.centre[0] - before[0], a.centre[1] - before[1], a.centre[2] - before[2]})};
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

void add_align_options(CLI::App& app, AlignCommand& command) {
  CLI::Option* align = app.add_flag(
      "--align", command.on, "First move O1 onto O2, by a rotation and a translation that fit the surfaces");
  app.add_option(
         "--align-from", command.from,
         "Where the alignment starts: none, O1 as it is placed; pca, where the principal axes agree; or a "
         "file with a 4x4 matrix, such as alignment.json")
      ->type_name("none|pca|FILE")
      ->needs(align)
      ->check(
          CLI::Validator([](const std::string& text) { return text.empty() ? "the name is empty" : ""; }, ""))
      ->capture_default_str();
}

AlignOutcome align_mesh(sdm::Mesh& o1, const sdm::Sites& o2, const AlignCommand& command,
                        const sdm::Progress& progress) {
  AlignOutcome outcome = timed(
      o2, command, progress, [&](const sdm::AlignOptions& options) { return sdm::align(o1, o2, options); },
      [&](const sdm::Alignment& found, const sdm::AlignOptions& options) {
        return sdm::find_other_unit(o1, o2, found, options);
      });
  sdm::transform(o1, outcome.alignment.transform);
  return outcome;
}

AlignOutcome align_points(std::span<const sdm::Vec3> points, std::span<const sdm::Vec3> normals,
                          const sdm::Sites& o2, const AlignCommand& command, const sdm::Progress& progress) {
  return timed(
      o2, command, progress,
      [&](const sdm::AlignOptions& options) { return sdm::align(points, normals, o2, options); },
      [&](const sdm::Alignment& found, const sdm::AlignOptions& options) {
        return sdm::find_other_unit(points, normals, o2, found, options);
      });
}

Json to_json(const AlignOutcome& outcome) {
  const sdm::Alignment& a = outcome.alignment;
  const auto [degrees, shift] = sizes(a);
  const auto residuals = [](const sdm::AlignResiduals& r) {
    return Json{{"rms", r.rms}, {"trimmed_rms", r.trimmed_rms}};
  };
  Json freedoms = Json::array();
  for (const sdm::DegreeOfFreedom& f : a.freedoms)
    freedoms.push_back({{"translation", f.translation},
                        {"rotation", f.rotation},
                        {"axis_point", f.axis_point ? Json(*f.axis_point) : Json()},
                        {"determined", f.determined},
                        {"standard_error", f.standard_error ? Json(*f.standard_error) : Json()},
                        {"free", f.free}});
  return {{"matrix", a.transform.rows},
          {"order", "row-major, for column vectors"},
          {"from", outcome.from},
          {"rotation_degrees", degrees},
          {"translation", shift},
          {"converged", a.converged},
          {"iterations", a.iterations},
          {"samples", a.samples},
          {"fraction_used", a.fraction_used},
          {"residuals_kind", "estimate"},
          {"before", residuals(a.before)},
          {"after", residuals(a.after)},
          {"centre", a.centre},
          {"gyration_radius", a.gyration_radius},
          {"degrees_of_freedom", freedoms},
          {"time_ms", outcome.time_ms}};
}

std::string summary(const AlignOutcome& outcome, const std::string& units) {
  const sdm::Alignment& a = outcome.alignment;
  const std::string unit = unit_suffix(units);
  const auto [degrees, shift] = sizes(a);
  return fmt::format(
      "  aligned   turned O1 by {}° and moved it by {}{}; residual rms {} -> {}{} ({} % of samples)\n",
      number(degrees, 4), number(shift, 4), unit, number(a.before.trimmed_rms, 3),
      number(a.after.trimmed_rms, 3), unit, number(100 * a.fraction_used, 4));
}

std::vector<std::string> notes(const AlignOutcome& outcome) {
  constexpr double kLarge = 0.005, kMany = 0.9;
  const sdm::Alignment& a = outcome.alignment;
  std::vector<std::string> notes;
  if (!a.converged)
    notes.push_back(
        fmt::format("the alignment did not converge in {} steps; its matrix is approximate", a.iterations));
  const char* question = outcome.from == "pca"
                             ? "is O1 the same part as O2?"
                             : "is O1 the same part as O2, or does it need --align-from pca?";
  if (a.after.trimmed_rms > kLarge * outcome.size)
    notes.push_back(fmt::format("the aligned surfaces are {} % of the size apart; {}",
                                number(100 * a.after.trimmed_rms / outcome.size, 2), question));
  else if (a.fraction_used < kMany)
    notes.push_back(fmt::format("{} % of the samples do not fit O2 and were taken for outliers; {}",
                                number(100 * (1 - a.fraction_used), 3), question));
  std::string free;
  for (const sdm::DegreeOfFreedom& f : a.freedoms)
    if (f.free) free += (free.empty() ? "" : ", ") + in_words(f, outcome.size);
  if (!free.empty())
    notes.push_back("the surfaces do not determine the alignment; these motions are as before: " + free);
  return notes;
}
