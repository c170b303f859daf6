// The note on thin walls, of lengths that are known.
#pragma once

#include <sdm/mesh_attributes.h>
#include <sdm/tolerance.h>

#include <optional>
#include <span>
#include <string>

namespace sdm::summary {

/// note_on_walls() of all tolerances together, by thickness::wall_lengths(). Cost: linear in faces and rows.
[[nodiscard]] std::optional<std::string> note_on_walls(std::span<const double> lengths,
                                                       const std::optional<Tolerance>& tolerance,
                                                       std::span<const FaceNames> names,
                                                       std::span<const GroupTolerance> table,
                                                       const std::string& units);

}  // namespace sdm::summary
