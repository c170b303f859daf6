// Bars with names and values, as SVG.
#pragma once

#include <string>
#include <vector>

namespace sdm::figures {

struct Bar {
  std::string name{};
  double value = 0;     ///< 0 or more
  std::string label{};  ///< the value with its unit, beside the bar
};

/// Returns a row for each bar, all from the same zero, 420 units wide.
[[nodiscard]] std::string bars(const std::string& title, const std::vector<Bar>& rows);

}  // namespace sdm::figures
