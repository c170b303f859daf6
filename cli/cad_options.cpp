#include "cad_options.h"

#include <algorithm>

#include "format.h"
#include "option_checks.h"

void add_deflection_option(CLI::App& app, sdm::TessellationOptions& options) {
  app.add_option("--deflection", options.deflection,
                 "The distance in mm that triangles of STEP and IGES may have from the surface, as "
                 "OpenCASCADE keeps it; by default 1/2000 of the diagonal. What was measured is reported, "
                 "as an estimate. Verdicts hold for the triangles")
      ->check(positive_number())
      ->type_name("D");
}

void check_deflection(const sdm::TessellationOptions& options, std::initializer_list<const Input*> inputs) {
  if (!options.deflection) return;
  if (std::ranges::none_of(inputs, [](const Input* input) { return input->tessellation.has_value(); }))
    throw CLI::ValidationError("--deflection", "applies to STEP and IGES, and no input is one of these");
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
