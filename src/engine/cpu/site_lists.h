// Lists of sites, transposed so that vector instructions test eight of them at once.
#pragma once

#include <sdm/sites.h>

#include <vector>

#include "sites/regions.h"

namespace sdm::cpu {

/// A site of O2, or none: no site within the limit, or (unsettled) single precision could not decide.
struct SiteId {
  static constexpr std::uint32_t kUnsettled = kNone - 1, kSiteMask = 0x3FFFFFFF;

  std::uint32_t packed = kNone;

  static constexpr SiteId of(SiteType type, std::uint32_t site) {
    return {static_cast<std::uint32_t>(type) << 30 | site};
  }
  [[nodiscard]] SiteType type() const {
    return packed >= kUnsettled ? SiteType::none : static_cast<SiteType>(packed >> 30);
  }
  [[nodiscard]] std::uint32_t site() const { return packed & kSiteMask; }
};

/// Eight regions of mesh/regions.h, a lane each: rows in the order of the region's numbers, then the site.
struct SiteBlock {
  static constexpr std::uint32_t kWidth = 8;
  std::uint32_t count = 0;
};
struct FaceBlock : SiteBlock {
  using Region = sites::FaceRegion;
  alignas(32) float plane[4][kWidth];
  alignas(32) float wall[3][4][kWidth];
  alignas(32) std::uint32_t id[kWidth];  ///< SiteId::packed
};
struct EdgeBlock : SiteBlock {
  using Region = sites::EdgeRegion;
  alignas(32) float start[3][kWidth];
  alignas(32) float direction[3][kWidth];
  alignas(32) float length[kWidth];
  alignas(32) float wall[2][4][kWidth];
  alignas(32) std::uint32_t id[kWidth];
};
struct VertexBlock : SiteBlock {
  using Region = sites::VertexRegion;
  alignas(32) float point[3][kWidth];
  alignas(32) float ray[sites::VertexRegion::kRays][3][kWidth];
  alignas(32) std::uint32_t id[kWidth];
};

/// All blocks are full but the last one.
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

}  // namespace sdm::cpu
