// Candidate lists, transposed so that vector instructions test eight sites at once.
#pragma once

#include <sdm/sites.h>

#include <cstddef>
#include <vector>

#include "sites/regions.h"

namespace sdm::closest {

/// A site of O2, or none: nothing within the limit, or (unsettled) nothing that single precision could
/// determine.
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

/// Up to eight sites, one per lane.
struct SiteBlock {
  static constexpr std::uint32_t kWidth = 8;
  using Row = float[kWidth];  ///< the same number of each site's region
  std::uint32_t count = 0;
};

/// The regions of up to eight sites, transposed: row[r][lane] is number r of a region of sites/regions.h.
template <class RegionType, std::size_t rows>
struct RegionBlock : SiteBlock {
  using Region = RegionType;
  static constexpr std::size_t kRows = rows;
  alignas(32) Row row[kRows];
  alignas(32) std::uint32_t id[kWidth];  ///< SiteId::packed
};

// The rows of each kind: a vector takes three, one for each coordinate, and a plane four.

struct FaceBlock : RegionBlock<sites::FaceRegion, 16> {
  static constexpr std::size_t kPlane = 0;
  static constexpr std::size_t wall(std::size_t k) { return 4 + 4 * k; }
};
struct EdgeBlock : RegionBlock<sites::EdgeRegion, 15> {
  static constexpr std::size_t kStart = 0, kDirection = 3, kLength = 6;
  static constexpr std::size_t wall(std::size_t k) { return 7 + 4 * k; }
};
struct VertexBlock : RegionBlock<sites::VertexRegion, 3 + 3 * sites::VertexRegion::kRays> {
  static constexpr std::size_t kPoint = 0;
  static constexpr std::size_t ray(std::size_t k) { return 3 + 3 * k; }
};

// The rows follow the order of the members.
static_assert(offsetof(sites::FaceRegion, plane) == FaceBlock::kPlane * sizeof(float) &&
              offsetof(sites::FaceRegion, wall) == FaceBlock::wall(0) * sizeof(float));
static_assert(offsetof(sites::EdgeRegion, start) == EdgeBlock::kStart * sizeof(float) &&
              offsetof(sites::EdgeRegion, direction) == EdgeBlock::kDirection * sizeof(float) &&
              offsetof(sites::EdgeRegion, length) == EdgeBlock::kLength * sizeof(float) &&
              offsetof(sites::EdgeRegion, wall) == EdgeBlock::wall(0) * sizeof(float));
static_assert(offsetof(sites::VertexRegion, point) == VertexBlock::kPoint * sizeof(float) &&
              offsetof(sites::VertexRegion, ray) == VertexBlock::ray(0) * sizeof(float));

/// All blocks but the last one are full.
template <class Block>
struct SiteList {
  std::vector<Block> blocks;  ///< grown as needed, never shrunk
  std::size_t used = 0;       ///< number of blocks in the list

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

}  // namespace sdm::closest
