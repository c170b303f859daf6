/// The solid that a closed mesh bounds.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/bounds.h>
#include <sdm/sites.h>

#include <optional>

namespace sdm {

/// Options of solid_volume().
struct SolidVolumeOptions {
  std::optional<bool> embedded{};  ///< is_embedded(), where it is known
};

/// Returns the volume of the points that a closed, orientable mesh winds around, with its shells oriented
/// outwards: parts that several shells cover count once. `exact`, to 1e-8 of the volume of the bounding box,
/// unless faces nearly coincide or many of them meet in a point without being connected there; `bounded`
/// then, with the middle of the bounds as its value. Throws sdm::Error for a mesh that is not closed and
/// orientable, or if there is not enough memory. Cost: that of is_embedded(); if the mesh is not embedded,
/// also that of dividing the faces that intersect others.
[[nodiscard]] SDM_API BoundedNumber solid_volume(const Sites& sites, const SolidVolumeOptions& options = {});

}  // namespace sdm
