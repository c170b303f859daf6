// The closest faces of two surfaces, by their two trees: no triangle is moved but those that are compared.
#pragma once

#include <vector>

#include "query/mesh_pair.h"

namespace sdm {

/// The work done, which tests hold down.
struct PairCounts {
  std::size_t nodes = 0;           ///< opened, and eight boxes tested against one
  std::size_t leaf_pairs = 0;      ///< of eight faces each, tested in single precision
  std::size_t triangle_pairs = 0;  ///< in double precision
};

/// What a thread keeps between searches: memory only, nothing that results depend on.
struct PairWorkspace {
  PairCounts counts;

  /// A node or leaf of the wide tree, and the binary node that has its box.
  struct Place {
    std::uint32_t child, source;
  };
  struct Entry {
    std::array<Place, 2> place;
    float least;  ///< lower bound on the distance; where boxes overlap, minus how far
  };
  std::vector<Entry> overlapping, apart;  ///< a stack, and a heap with the nearest first
  std::vector<std::uint32_t> nodes;

  /// The faces of a leaf, a lane each, in O1's unit frame.
  struct Faces {
    static constexpr int kWidth = WideTree::kWidth;
    alignas(32) float corner[3][3][kWidth];  ///< by corner and axis
    alignas(32) float lo[3][kWidth], hi[3][kWidth];
    alignas(32) float normal[3][kWidth];  ///< of length 1, or 0
    /// Extents along the face's own normal, and along the direction between the closest points so far.
    alignas(32) float near[kWidth], far[kWidth], along_lo[kWidth], along_hi[kWidth];
    std::uint32_t first, count;
  };
  Faces faces[2];
};

/// The closest points of the two surfaces, if their distance is at most `bound`. Cost: logarithmic where the
/// surfaces are apart, linear at worst in the pairs of faces that compete; one thread, no allocation once the
/// workspace has grown.
[[nodiscard]] Separation find_closest(const MeshPair& pair, double bound, PairWorkspace& workspace);

/// Faces of the two surfaces that have a point in common, if any; decided exactly.
[[nodiscard]] Separation find_intersection(const MeshPair& pair, PairWorkspace& workspace);

}  // namespace sdm
