// Lists of sites in the blocks of mesh/regions.h, so that one kernel serves the tree's leaves and the lists.
#pragma once

#include <vector>

#include "mesh/regions.h"

namespace sdm {

/// All blocks are full but the last one. Of a site the rows of its region and its number are kept.
template <class Block>
struct SiteList {
  std::vector<Block> blocks;  ///< grown as needed, never shrunk
  std::size_t used = 0;       ///< blocks that hold the list

  [[nodiscard]] std::size_t size() const {
    return used == 0 ? 0 : Block::kWidth * (used - 1) + blocks[used - 1].count;
  }
};

struct SiteLists {
  SiteList<FaceBlock> faces;
  SiteList<EdgeBlock> edges;
  SiteList<VertexBlock> vertices;

  [[nodiscard]] std::size_t size() const { return faces.size() + edges.size() + vertices.size(); }
  void clear() { faces.used = edges.used = vertices.used = 0; }
};

}  // namespace sdm
