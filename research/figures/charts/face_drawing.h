// Faces in a plane with their samples.
#pragma once

#include <sdm/surface.h>

#include <string>
#include <string_view>

namespace sdm::figures {

/// The faces of a surface in the plane z = 0 with their samples, `per_unit` units of the drawing for each
/// unit of length, at most 640.
[[nodiscard]] std::string faces_with_samples(std::string_view title, const Surface& surface, double per_unit);
/// The same in the atlas.
[[nodiscard]] std::string atlas_with_samples(std::string_view title, const Surface& surface,
                                             double per_texel);

}  // namespace sdm::figures
