#include <sdm/measure.h>
#include <sdm/summary.h>

#include <algorithm>
#include <cmath>

#include "closest/facing/facing_normals.h"
#include "core/larger_units.h"
#include "core/numbers/number_text.h"
#include "geometry/triangle.h"
#include "geometry/vec.h"
#include "map/measures/walls.h"
#include "summary/wall_note.h"

namespace sdm {
namespace {

/// The text of a number with at most so many significant digits; below a million without an exponent.
std::string text_of(double number, int digits) {
  constexpr double kLong = 1e6;
  if (std::abs(number) >= std::pow(10, digits) && std::abs(number) < kLong) {
    const double unit = std::pow(10, std::floor(std::log10(std::abs(number))) + 1 - digits);
    return std::to_string(std::lround(unit * std::round(number / unit)));
  }
  return number_text(number, digits);
}

bool is_empty(const Box& box) {
  return !(box.lower[0] <= box.upper[0]);
}

std::optional<std::string> note_of_lengths(std::span<const double> lengths, double limit,
                                           const std::string& units) {
  constexpr double kLeastShare = 0.01;  // less may be edges that are sharper than a right angle
  const std::optional<WallEstimate> walls = thickness::estimate_walls(lengths, 2 * limit);
  if (!walls || walls->thin < kLeastShare) return std::nullopt;
  const std::string unit = units.empty() ? "" : " " + units;
  return "about " + std::to_string(std::lround(100 * walls->thin)) +
         " % of O2's walls are thinner than twice the tolerance, " + text_of(2 * limit, 5) + unit +
         " (an estimate: half of these are at most " + text_of(walls->median, 3) + unit +
         " thick), so that the closest point may be on the other skin, and a defect does not show; --facing "
         "measures to the faces that face the same way";
}

/// The largest limit of all tolerances; nothing without any.
std::optional<double> largest_of(const std::optional<Tolerance>& tolerance, std::span<const FaceNames> names,
                                 std::span<const GroupTolerance> table) {
  std::optional<double> largest;
  const auto add = [&](const Tolerance& limits) {
    for (const double limit : {limits.lower, limits.upper})
      if (std::isfinite(limit)) largest = std::max(largest.value_or(0), std::abs(limit));
  };
  if (tolerance) add(*tolerance);
  const std::vector<NamedFaces> named = faces_of_groups(names, table);
  for (std::size_t row = 0; row < table.size(); ++row)
    if (!named[row].faces.empty()) add(table[row].tolerance);
  return largest;
}

}  // namespace

std::optional<std::string> note_on_sizes(const Box& a, const Box& b) {
  constexpr double kTolerance = 0.05;
  constexpr LargerUnit kCentimetre = kLargerUnits.front(), kMetre = kLargerUnits.back();
  const double sizes[] = {diagonal(a), diagonal(b)};
  const double times = std::max(sizes[0], sizes[1]) / std::min(sizes[0], sizes[1]);
  if (!std::isfinite(times)) return std::nullopt;
  const auto question = [&](double ratio, const std::string& smaller,
                            const char* larger) -> std::optional<std::string> {
    if (!(std::abs(times / ratio - 1) <= kTolerance)) return std::nullopt;
    return "one mesh is about " + text_of(ratio, 6) + " times the other; " + smaller + " and " + larger + "?";
  };
  for (const auto& [ratio, name] : kLargerUnits)
    if (auto note = question(ratio, "millimetres", name)) return note;
  if (auto note = question(kMetre.millimetres / kCentimetre.millimetres, kCentimetre.name, kMetre.name))
    return note;
  if (times > kMetre.millimetres)
    return "one mesh is about " + text_of(times, 2) + " times the other; are both in the same units?";
  return std::nullopt;
}

std::optional<std::string> note_on_places(const Box& a, const Box& b) {
  constexpr double kFar = 100;
  const double size = std::max(diagonal(a), diagonal(b)), apart = norm(gap(a, b));
  if (!(apart > kFar * size)) return std::nullopt;
  return "the meshes are " + text_of(apart / size, 2) +
         " times their size apart; are both in the same place?";
}

std::optional<std::string> note_on_walls(const Sites& sites, const Tolerance& tolerance,
                                         const std::string& units) {
  const double limit = std::max(std::abs(tolerance.lower), std::abs(tolerance.upper));
  return note_of_lengths(thickness::wall_lengths(sites), limit, units);
}

std::optional<std::string> summary::note_on_walls(std::span<const double> lengths,
                                                  const std::optional<Tolerance>& tolerance,
                                                  std::span<const FaceNames> names,
                                                  std::span<const GroupTolerance> table,
                                                  const std::string& units) {
  const std::optional<double> largest = largest_of(tolerance, names, table);
  return largest ? note_of_lengths(lengths, *largest, units) : std::nullopt;
}

std::optional<std::string> note_on_walls(const Sites& sites, const std::optional<Tolerance>& tolerance,
                                         std::span<const FaceNames> names,
                                         std::span<const GroupTolerance> table, const std::string& units) {
  const std::optional<double> largest = largest_of(tolerance, names, table);
  return largest ? note_of_lengths(thickness::wall_lengths(sites), *largest, units) : std::nullopt;
}

std::optional<std::string> note_on_directions(const Mesh& surface, double facing, const std::string& units) {
  const facing::FacingNormals found = facing::facing_normals(surface, facing);
  if (found.replaced.empty()) return std::nullopt;
  const auto area_of = [&](std::size_t face) {
    const auto [a, b, c] = corners_of(surface, face);
    return norm(cross(b - a, c - a)) / 2;
  };
  double area = 0, all = 0;
  for (const std::uint32_t face : found.replaced) area += area_of(face);
  for (std::size_t face = 0; face < surface.triangles.size(); ++face)
    if (!is_removed(surface.triangles[face])) all += area_of(face);
  const bool one = found.replaced.size() == 1;
  return "the direction of " + std::to_string(found.replaced.size()) + (one ? " face" : " faces") +
         " lower than " + text_of(found.height, 2) + (units.empty() ? "" : " " + units) + ", with " +
         text_of(100 * area / all, 2) + " % of the area, is ignored: so small, it is noise, and that of " +
         (one ? "its" : "their") + " surroundings counts";
}

std::vector<std::string> notes_on(const Box& a, const Box& b) {
  std::vector<std::string> notes;
  if (is_empty(a) || is_empty(b)) return notes;
  if (auto note = note_on_sizes(a, b)) notes.push_back(std::move(*note));
  if (auto note = note_on_places(a, b)) notes.push_back(std::move(*note));
  return notes;
}

}  // namespace sdm
