#include "unit_options.h"

#include <fmt/format.h>
#include <sdm/mesh.h>

#include <filesystem>

namespace {

constexpr const char* kCad = "mm";

/// That of all files of a format, by the extension; empty if there is none. CAD is converted when it is read.
std::string unit_of_format(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (extension == ".glb" || extension == ".gltf") return "m";
  for (const char* cad : {".step", ".stp", ".iges", ".igs"})
    if (extension == cad) return kCad;
  return {};
}

/// The unit of a file: as given, as its format has it, or that of all lengths.
std::string unit_of(const std::string& given, const std::string& file, const std::string& units,
                    const char* option) {
  if (!given.empty()) return given;
  if (std::string unit = unit_of_format(file); !unit.empty()) return unit;
  if (units.empty())
    throw CLI::ValidationError(option, fmt::format("is needed, as {} does not state its units", file));
  return units;
}

void scale_first(std::string& transform, double factor) {
  if (factor == 1) return;
  constexpr int kExact = 15;  // digits: ratios of units are decimal numbers, or their inverses
  transform = fmt::format("scale:{:.{}g}{}{}", factor, kExact, transform.empty() ? "" : ",", transform);
}

// Steps but these keep lengths.
bool may_scale(const std::string& transform) {
  for (const char* step : {"fit", "scale", "matrix"})
    if (transform.find(step) != std::string::npos) return true;
  return false;
}

}  // namespace

void check_units(const std::string& units, const std::string& file, const std::string& transform,
                 const char* advice) {
  if (units.empty() || units == kCad || may_scale(transform) || unit_of_format(file) != kCad) return;
  throw CLI::ValidationError("--units",
                             fmt::format("must be mm, not {}, as {} is read in mm{}", units, file, advice));
}

void add_unit_options(CLI::App& app, UnitOptions& units) {
  const auto add = [&](const char* option, const char* mesh, std::string& unit) {
    app.add_option(option, unit,
                   fmt::format("The unit of the coordinates in the file of {}, m, cm, mm, um, in or ft: both "
                               "files are converted to the unit of --units or else to that of O2; glTF is "
                               "in m, STEP and IGES are read in mm",
                               mesh))
        ->check(CLI::Validator(
            [](const std::string& text) {
              return sdm::metres_per(text) ? std::string() : text + " is not one of m, cm, mm, um, in, ft";
            },
            ""))
        ->type_name("UNIT");
  };
  add("--units-o1", "O1", units.o1);
  add("--units-o2", "O2", units.o2);
}

void convert_units(const UnitOptions& options, const ConvertedPair& pair) {
  if (options.o1.empty() && options.o2.empty()) {
    constexpr const char* kAdvice = "; with --units-o1 or --units-o2, both files are converted";
    check_units(pair.units, pair.file_o1, pair.transform_o1, kAdvice);
    check_units(pair.units, pair.file_o2, pair.transform_o2, kAdvice);
    return;
  }
  const std::string o1 = unit_of(options.o1, pair.file_o1, pair.units, "--units-o1");
  const std::string o2 = unit_of(options.o2, pair.file_o2, pair.units, "--units-o2");
  if (pair.units.empty()) pair.units = o2;
  const std::optional<double> target = sdm::metres_per(pair.units);
  if (!target)
    throw CLI::ValidationError("--units", fmt::format("{} is not one of m, cm, mm, um, in, ft, to which "
                                                      "--units-o1 and --units-o2 convert",
                                                      pair.units));
  const auto factor = [&](const std::string& unit) { return *sdm::metres_per(unit) / *target; };
  scale_first(pair.transform_o1, factor(o1));
  scale_first(pair.transform_o2, factor(o2));
}
