#include "field.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/map_files.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <limits>

#include "declared_options.h"
#include "format.h"
#include "option_checks.h"
#include "unit_options.h"

namespace {

void extend(sdm::Box& box, const sdm::Box& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    box.lower[k] = std::min(box.lower[k], other.lower[k]);
    box.upper[k] = std::max(box.upper[k], other.upper[k]);
  }
}

}  // namespace

sdm::Grid grid_of(const FieldCommand& command, const sdm::Mesh& o2, const sdm::Box& more) {
  sdm::Box box;
  if (!command.bounds.empty()) {
    for (std::size_t k = 0; k < 3; ++k) {
      box.lower[k] = command.bounds[k];
      box.upper[k] = command.bounds[k + 3];
    }
  } else {
    box = sdm::bounds(o2);
    const double diagonal = size_of(box);
    const double farthest = command.options.max_distance;
    const double margin = farthest < std::numeric_limits<double>::infinity() ? farthest : 0.1 * diagonal;
    for (std::size_t k = 0; k < 3; ++k) {
      box.lower[k] -= margin;
      box.upper[k] += margin;
    }
    extend(box, more);
  }
  if (command.points.empty()) return sdm::make_grid(box, command.spacing);
  return sdm::make_grid(box, {command.points[0], command.points[1], command.points[2]});
}

std::string field_lines(const FieldCommand& command, const sdm::DistanceField& field) {
  const std::string unit = unit_suffix(command.units);
  const sdm::Grid& grid = field.grid;
  std::string text = fmt::format("{}\n  grid       {} x {} x {} points, {} {} {}{} apart\n", command.o2,
                                 grid.dims[0], grid.dims[1], grid.dims[2], number(grid.spacing[0]),
                                 number(grid.spacing[1]), number(grid.spacing[2]), unit);
  const auto [min, max] = sdm::distance_range(field);
  if (field.beyond_max_distance == field.distance.size())
    text += "  distance   no point is within the maximum distance\n";
  else
    text += fmt::format("  distance   min {}   max {}{}, to {}\n", number(min), number(max), unit,
                        number(field.accuracy, 2));
  if (field.sign.method == sdm::SignMethod::none)
    text += fmt::format("             unsigned: {}\n", field.sign.reason);
  if (field.beyond_max_distance > 0)
    text +=
        fmt::format("             {} points are beyond the maximum distance\n", field.beyond_max_distance);
  return text;
}

void check_field_options(const FieldCommand& command) {
  if (command.points.empty() == (command.spacing == 0))
    throw CLI::ValidationError("--grid", "give either --grid or --spacing");
  for (std::size_t k = 0; k < 3 && !command.bounds.empty(); ++k)
    if (!(command.bounds[k] <= command.bounds[k + 3]))
      throw CLI::ValidationError("--bounds", "the first three numbers are the lowest coordinates");
  check_units(command.units, command.o2, command.transform_o2);
  if (command.out.empty()) return;
  try {
    sdm::check_field_format(command.out);
  } catch (const sdm::Error& error) {
    throw CLI::ValidationError("--output", error.what());
  }
}

void add_field_options(CLI::App& app, FieldCommand& command, const std::string& box) {
  app.add_option("O2", command.o2,
                 fmt::format("The mesh that distances are measured to ({})", sdm::mesh_format_names()))
      ->required();
  app.add_option("-o,--output", command.out, "The file: " + sdm::field_format_names())->type_name("FILE");
  app.add_option("--grid", command.points, "Points along x, y and z")
      ->expected(3)
      ->transform(whole_number(1, sdm::Grid::kMostPoints))
      ->type_name("NX NY NZ");
  app.add_option("--spacing", command.spacing,
                 "The distance of neighbouring points along each axis, in place of --grid")
      ->check(positive_number())
      ->type_name("H");
  app.add_option("--bounds", command.bounds,
                 "The lowest and the highest corner of the grid; by default the box of O2, extended by the "
                 "maximum distance, or by a tenth of its diagonal" +
                     box)
      ->expected(6)
      ->check(any_number())
      ->type_name("X0 Y0 Z0 X1 Y1 Z1");
  add_declared_options(app, command.options, {}, {{"sites", "Also find the closest sites (in .vti)."}});
  add_transform_option(app, "--transform-o2", "O2", command.transform_o2);
  add_units_option(app, command.units);
  add_run_options(app, command, "JSON instead of a summary");
}
