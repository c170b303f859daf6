// Faces that collapses leave without an area in the texture, or on their back there.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <vector>

#include "simplify/wedges.h"

namespace sdm::simplify {

/// Sets the turns of the wedges, and the faces that are flat in the texture. Cost: linear.
void find_turns(Wedges& wedges);

/// Whether a face has no area in the texture, rounded to float as glTF keeps it, or does not wind as its
/// chart does. Charts with faces of both windings permit either; faces of the input are right.
[[nodiscard]] bool is_wrong_in_texture(const Wedges& wedges, const Triangle& triangle);

/// Flips edges of such faces. Returns those that are left. Cost: linear.
[[nodiscard]] std::vector<std::uint32_t> mend_in_texture(const Wedges& wedges,
                                                         std::vector<Triangle>& triangles);

}  // namespace sdm::simplify
