#include "cad_options.h"

#include <algorithm>
#include <cmath>

#include "declared_options.h"
#include "format.h"
#include "src/geometry/stretch.h"

void add_deflection_option(CLI::App& app, sdm::TessellationOptions& options) {
  add_declared_option(app, sdm::option_of(&sdm::TessellationOptions::deflection), options.deflection);
}

void check_deflection(const sdm::TessellationOptions& options, std::initializer_list<const Input*> inputs) {
  check_deflection(options, std::ranges::any_of(
                                inputs, [](const Input* input) { return input->tessellation.has_value(); }));
}

void check_deflection(const sdm::TessellationOptions& options, bool some_are_cad) {
  if (options.deflection && !some_are_cad)
    throw CLI::ValidationError("--deflection", "applies to STEP and IGES, and no input is one of these");
}

std::optional<double> deflection_for(const sdm::Tolerance& tolerance) {
  constexpr double kPart = 0.1;
  const auto [lo, hi] = tolerance;
  const double width = std::isfinite(lo) && std::isfinite(hi) ? (hi - lo) / 2 : sdm::largest_limit(tolerance);
  return width > 0 ? std::optional(kPart * width) : std::nullopt;
}

std::optional<double> deflection_for(const std::optional<sdm::Tolerance>& tolerance,
                                     std::span<const sdm::GroupTolerance> rows) {
  std::optional<double> least;
  const auto add = [&](const sdm::Tolerance& limits) {
    if (const auto d = deflection_for(limits)) least = std::min(least.value_or(*d), *d);
  };
  if (tolerance) add(*tolerance);
  for (const sdm::GroupTolerance& row : rows) add(row.tolerance);
  return least;
}

sdm::TessellationOptions before_placement(sdm::TessellationOptions options,
                                          const std::vector<sdm::io::PlacementStep>& steps) {
  if (!options.at_most) return options;
  const bool fits = std::ranges::any_of(
      steps, [](const auto& step) { return step.kind == sdm::io::PlacementStep::Kind::fit; });
  const double stretch = fits ? 0 : sdm::largest_stretch(sdm::io::transform_of(steps));
  if (stretch > 0)
    *options.at_most /= stretch;
  else
    options.at_most.reset();
  return options;
}

double placed_deviation(const std::optional<sdm::Tessellation>& tessellation,
                        const std::vector<sdm::io::PlacementStep>& steps) {
  if (!tessellation) return 0;
  return tessellation->largest_deviation * sdm::largest_stretch(sdm::io::transform_of(steps));
}

std::vector<std::pair<const char*, std::string>> rows_of(const sdm::Tessellation& t) {
  return {{"unit", t.file_unit.empty() ? std::string("none in the file; coordinates are taken for mm")
                                       : fmt::format("{} in the file, converted to mm", t.file_unit)},
          {"CAD faces", t.omitted_faces == 0
                            ? fmt::to_string(t.faces)
                            : fmt::format("{}, of which {} are missing", t.faces, t.omitted_faces)},
          {"deflection", fmt::format("{} mm and {} rad", number(t.deflection), number(t.angle))},
          {"largest deviation", fmt::format("{} mm (estimate, measured at {} points)",
                                            number(t.largest_deviation), t.measured_points)}};
}
