// How far the surface strays from its samples.
#pragma once

#include <sdm/surface.h>

namespace sdm {

/// An upper bound on the distance of any point of any face (those without texel or chart included) to the
/// nearest sample; infinite when there is no sample. Cost: linear in texels, all cores.
[[nodiscard]] double sampling_bound(const Surface& surface);

}  // namespace sdm
