#include <sdm/mesh.h>

#include "core/rules.h"

namespace sdm {

std::optional<double> metres_per(std::string_view unit) {
  for (const auto& [name, metres] : rules::kUnits)
    if (name == unit) return metres;
  return std::nullopt;
}

}  // namespace sdm
