// How far the surface may be from its samples.
#pragma once

#include <sdm/surface.h>

namespace sdm {

/// An upper bound on the distance of any point of the surface to the nearest sample. Cost: linear in faces and texels.
[[nodiscard]] double sampling_bound(const Surface& surface);

}  // namespace sdm
