// Numbers and lengths as text.
#pragma once

#include <fmt/format.h>
#include <sdm/types.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

/// The shortest form with at most this many significant digits.
[[nodiscard]] inline std::string number(double value, int digits = 5) {
  return fmt::format("{:.{}g}", value, digits);
}

/// The diagonal of a box.
[[nodiscard]] inline double size_of(const sdm::Box& box) {
  return std::hypot(box.upper[0] - box.lower[0], box.upper[1] - box.lower[1], box.upper[2] - box.lower[2]);
}

/// A coordinate, to 1e-5 of `size` or better, and to `digits` significant digits at least: wherever a mesh
/// lies, its places differ.
[[nodiscard]] inline std::string coordinate(double value, double size, int digits = 5) {
  constexpr double kResolution = 1e-5;
  constexpr int kMost = 15;  // all that a double has of any decimal number
  if (value != 0 && size > 0 && std::isfinite(value) && std::isfinite(size))
    digits = std::clamp(static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1 -
                            static_cast<int>(std::floor(std::log10(kResolution * size))),
                        digits, kMost);
  return number(value, digits);
}

/// A point of a mesh of that size, as (x y z).
[[nodiscard]] inline std::string place(const sdm::Vec3& p, double size) {
  return fmt::format("({} {} {})", coordinate(p[0], size), coordinate(p[1], size), coordinate(p[2], size));
}

/// The units after a number, such as " mm"; empty without units.
[[nodiscard]] inline std::string unit_suffix(std::string_view units) {
  return units.empty() ? std::string() : fmt::format(" {}", units);
}

/// How long a command took, the files of its report, and last, to be opened, the pages if there are any; the
/// texts begin in the given column. `page_folders`: those of the pages, if they are others.
[[nodiscard]] inline std::string result_lines(std::size_t column, double ms, const std::string& folder,
                                              const std::string& files,
                                              std::vector<std::string> page_folders = {}) {
  const std::size_t width = column - 2;
  std::string text = fmt::format("  {:<{}}{} s\n  {:<{}}{}/: {}report.json\n", "time", width,
                                 number(std::round(ms) / 1000, 6), "results", width, folder, files);
  if (page_folders.empty()) page_folders.push_back(folder);
  if (files.find("report.html") != std::string::npos)
    for (const std::string& page_folder : page_folders)
      text += fmt::format("  {:<{}}{}/report.html\n", "page", width, page_folder);
  return text;
}
