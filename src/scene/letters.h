// Letters as solids.
#pragma once

#include <sdm/mesh.h>

#include <cstddef>

namespace sdm {

/// A letter's depth, along z; it is 1 high, along y.
inline constexpr double kLetterDepth = 0.3;

/// A letter of DejaVu Sans Bold, centred at the origin, that reads from +z: closed, faces outward, with edges
/// of about `spacing` everywhere. Throws sdm::Error for a character without a shape, or with parts too thin
/// for the spacing.
[[nodiscard]] Mesh letter(char character, double spacing);

/// The same at the spacing that comes nearest to a number of triangles.
[[nodiscard]] Mesh letter_of(char character, std::size_t triangles);

}  // namespace sdm
