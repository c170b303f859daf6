/// The solid that a closed mesh bounds.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/sites.h>

namespace sdm {

/// Bounds on a volume; equal where it is exact, to 1e-8 of that of the bounding box.
struct VolumeBounds {
  double lower = 0, upper = 0;
};

/// The volume of the points that a closed, orientable mesh winds around, with its shells oriented outwards:
/// parts that several shells cover count once. Exact, unless faces nearly coincide or many of them meet in a
/// point, without being connected there. Throws
/// sdm::Error for a mesh that is not closed and orientable, or if there is not enough memory. Cost: that of
/// is_embedded(); if the mesh is not embedded, also that of dividing the faces that intersect others.
[[nodiscard]] SDM_API VolumeBounds solid_volume(const Sites& sites);
/// The same, where is_embedded() is known.
[[nodiscard]] SDM_API VolumeBounds solid_volume(const Sites& sites, bool embedded);

}  // namespace sdm
