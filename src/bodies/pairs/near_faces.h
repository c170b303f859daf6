// The faces of two surfaces that are near the other surface.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bodies/pairs/pair_search.h"

namespace sdm::pairs {

/// Faces of O1 and of O2, as bits for the faces of each leaf, in the order of the trees.
struct NearFaces {
  std::array<std::vector<std::uint8_t>, 2> of_leaf;
  std::array<std::vector<std::uint32_t>, 2> leaves;    ///< those with faces, in no order
  std::array<std::vector<std::uint32_t>, 2> opposite;  ///< of those: a face of the other surface that is near
};

/// Memory for reuse between searches.
struct NearFacesWorkspace {
  struct Half {
    std::array<std::vector<std::uint8_t>, 2>
        whole;                               ///< of each wide node: whether all faces below it are near
    std::vector<PairWorkspace::Entry> open;  ///< pairs of nodes
  };
  std::array<Half, 2> halves;
  NearFaces second;  ///< found by the second half
};

/// Finds all faces within `max_distance` of the other surface. If it is 0, exactly those that have a point in
/// common with it; otherwise, some that are farther away may be among them. Cost: of the pairs of nodes that
/// are so close, but for those whose faces are all known; on two cores if there are many, without allocation
/// once the memory has grown.
void find_near_faces(const MeshPair& pair, double max_distance, NearFacesWorkspace& workspace,
                     NearFaces& near);

}  // namespace sdm::pairs
