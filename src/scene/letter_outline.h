// The outlines of letters, from a font.
#pragma once

#include <sdm/types.h>

#include <vector>

namespace sdm {

/// A closed polygon; its last corner is joined to the first. The letter is on its left.
using Contour = std::vector<Vec2>;

/// The contours of a character in DejaVu Sans Bold, 1 high and centred at the origin. Their sides are about
/// `spacing` long, and their corners those of the letter. Throws sdm::Error for a character without a shape.
[[nodiscard]] std::vector<Contour> letter_outline(char character, double spacing);

}  // namespace sdm
