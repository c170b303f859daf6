#include "map/places/place_limits.h"

#include <algorithm>
#include <map>
#include <utility>

namespace sdm::map {

FaceTolerances::FaceTolerances(const std::optional<Tolerance>& of_all, std::span<const FaceNames> names,
                               std::span<const GroupTolerance> table)
    : tolerances_{of_all.value_or(any_distance())}, has_any_(of_all || !table.empty()) {
  if (table.empty() || names.empty()) return;
  const std::vector<NamedFaces> named = faces_of_groups(names, table);
  number_.assign(names.front().of_face.size(), 0);
  // The tolerances that a tolerance and a row that is added to it have in common. Faces of several rows are
  // few.
  std::map<std::pair<std::uint32_t, std::size_t>, std::uint32_t> joined;
  for (std::size_t row = 0; row < table.size(); ++row)
    for (const std::uint32_t face : named[row].faces) {
      const auto [place, is_new] =
          joined.try_emplace({number_[face], row}, static_cast<std::uint32_t>(tolerances_.size()));
      if (is_new) {
        const Tolerance before = tolerances_[number_[face]], &more = table[row].tolerance;
        tolerances_.emplace_back(std::max(before.lower, more.lower), std::min(before.upper, more.upper));
      }
      number_[face] = place->second;
    }
}

}  // namespace sdm::map
