/// The solid that a closed mesh bounds.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/sites.h>

namespace sdm {

/// Bounds on a volume; equal where it is exact, to rounding.
struct VolumeBounds {
  double lower = 0, upper = 0;
};

/// The volume of the points that a closed, orientable mesh winds around, with its shells oriented outwards:
/// parts that several shells cover count once. Exact for an embedded mesh (see is_embedded). Throws
/// sdm::Error for a mesh that is not closed and orientable, or if there is not enough memory. Cost: that of
/// is_embedded(); if the mesh is not embedded, also that of dividing the faces that intersect others.
[[nodiscard]] SDM_API VolumeBounds solid_volume(const Sites& sites);

}  // namespace sdm
