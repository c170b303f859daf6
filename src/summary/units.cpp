#include <sdm/units.h>

#include <array>
#include <utility>

namespace sdm {

std::optional<double> metres_per(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, double>, 6> kUnits{
      {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}}};
  for (const auto& [name, metres] : kUnits)
    if (name == unit) return metres;
  return std::nullopt;
}

}  // namespace sdm
