// The triangles of a page in an order in which numbers at their vertices can be guessed from those before.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sdm::io {

/// Triangles, each across an edge of an earlier one wherever there is one left, with vertices numbered in the
/// order of their first use.
struct FaceWalk {
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> from;    ///< of each triangle, its number among those given
  std::vector<std::uint32_t> vertex;  ///< of each vertex, its number among those given
};

/// Walks over triangles of `vertices` vertices; from the first one that is left where no edge leads on.
/// Corners keep their direction of turning. Cost: linear.
[[nodiscard]] FaceWalk walk_over(std::span<const Triangle> triangles, std::size_t vertices);

/// The vertices from which a number at a vertex is guessed: x[a] + x[b] − x[c], which completes a
/// parallelogram over an edge of an earlier triangle, or a = b = c; kNone: from none. All are before it.
/// Vertices must be numbered in the order of their first use. Cost: linear. `guessesOf` of
/// report/src/arrays.ts is the same.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> guesses_of(std::span<const Triangle> triangles);

}  // namespace sdm::io
