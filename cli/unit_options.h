// --units-o1 and --units-o2: the coordinates of files in other units of length are converted. --units of CAD.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

struct UnitOptions {
  std::string o1, o2;  ///< empty: not given
};

/// Adds both options.
void add_unit_options(CLI::App& app, UnitOptions& units);

/// Throws CLI::ValidationError if `file` is CAD, which is read in millimetres, and `units`, that of --units,
/// is another unit, unless the transform may convert it. `advice` ends the message.
void check_units(const std::string& units, const std::string& file, const std::string& transform,
                 const char* advice = "");

/// The files and placements that are converted, and the unit of all lengths, empty if it is not known.
struct ConvertedPair {
  const std::string &file_o1, &file_o2;
  std::string &transform_o1, &transform_o2, &units;
};

/// If one of the options is given: scales both files, before their transforms, to `units`, by default that of
/// O2, which is then set. Else as check_units() for both. glTF is in metres, and CAD in millimetres; another
/// file without its option is in `units`. Throws CLI::ValidationError for a file whose unit is not known.
void convert_units(const UnitOptions& options, const ConvertedPair& pair);
