// Charts with axes, units and a legend, as SVG.
#pragma once

#include <string>
#include <vector>

namespace sdm::figures {

struct Axis {
  std::string label{};  ///< with the unit
  bool log = false;
  bool from_zero = true;  ///< linear: the axis begins at 0 unless there are negative values
};

struct Series {
  std::string name{};
  /// Points that are not finite, or not positive on a logarithmic axis, are left out.
  std::vector<double> x{}, y{};
  bool dots = true;
  bool line = true;
  bool dashed = false;
};

/// A vertical line at a value of the x axis.
struct Mark {
  double x = 0;
  std::string label{};
};

struct Chart {
  std::string title{};
  Axis x{}, y{};
  std::vector<Series> series{};
  std::vector<Mark> marks{};
};

/// Returns the chart as SVG, 600 units wide, with text of 14 units.
[[nodiscard]] std::string to_svg(const Chart& chart);

}  // namespace sdm::figures
