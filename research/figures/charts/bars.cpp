#include "research/figures/charts/bars.h"

#include <algorithm>

#include "research/figures/charts/svg.h"

namespace sdm::figures {

std::string bars(const std::string& title, const std::vector<Bar>& rows) {
  constexpr double kWidth = 420, kNames = 212, kLabels = 60, kRow = 22, kTop = 36;
  double most = 0;
  for (const Bar& bar : rows) most = std::max(most, bar.value);
  Svg svg(kWidth, kTop + kRow * static_cast<double>(rows.size()) + 8, title);
  svg.text({4, 22}, title, 15, "start", true);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double top = kTop + kRow * static_cast<double>(i), text = top + 15;
    const double right = kNames + (kWidth - kNames - kLabels) * (most > 0 ? rows[i].value / most : 0);
    svg.text({kNames - 8, text}, rows[i].name, 13, "end");
    const Vec2 corners[] = {
        {kNames, top + 4}, {right, top + 4}, {right, top + kRow - 4}, {kNames, top + kRow - 4}};
    svg.polygon(corners, kSeriesColors[0], 1, {kSeriesColors[0], 0.5});
    svg.text({right + 6, text}, rows[i].label, 13);
  }
  svg.line({kNames, kTop}, {kNames, kTop + kRow * static_cast<double>(rows.size())}, {kAxisColor});
  return std::move(svg).finished();
}

}  // namespace sdm::figures
