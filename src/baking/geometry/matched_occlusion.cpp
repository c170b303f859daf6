#include <sdm/bake.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <new>
#include <vector>

#include "baking/geometry/texel_walk.h"
#include "closest/facing/facing_normals.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/spatial_order.h"
#include "geometry/vec.h"
#include "rays/hemisphere_rays.h"
#include "rays/parallel_rays.h"
#include "sites/sites_data.h"

namespace sdm {
namespace {

constexpr std::size_t kMost = rays::RayOrigins::kMost;
constexpr std::size_t kGroups = 8;  // of directions, whose means say how much they differ

/// The sums of the rays in a group of directions, of each point.
struct RaySums {
  std::array<float, kMost> cosines{}, free{};
};

/// What a thread keeps.
struct OcclusionTile {
  std::vector<std::uint32_t> texels;
  std::vector<Vec3> points;
  rays::RayOrigins origins;
  std::array<Vec3, kMost> normals;
  std::array<RaySums, kGroups> groups;
  std::vector<std::uint32_t> stack;
};

class OcclusionRays {
 public:
  OcclusionRays(const sites::SitesData& sites, const TexelMatches& matches,
                const AmbientOcclusionOptions& options)
      : sites_(sites),
        matches_(matches),
        above_(kAbove * diagonal(bounds(sites.mesh))),
        max_distance_(options.max_distance),
        corners_(sites),
        directions_(options.rays) {
    rays::uniform_hemisphere(options.seed, directions_);
  }

  /// Sets the estimates of the texels. Those near each other share searches.
  void trace(OcclusionTile& tile, OcclusionEstimate& result) const {
    tile.points.clear();
    for (const std::uint32_t texel : tile.texels)
      tile.points.push_back(baking::position_of(sites_.mesh, matches_.point(texel)));
    const std::vector<std::uint32_t> order = spatial_order(tile.points);
    for (std::size_t begin = 0; begin < order.size(); begin += kMost) {
      tile.origins.count = std::min(kMost, order.size() - begin);
      for (std::size_t i = 0; i < tile.origins.count; ++i) {
        const std::uint32_t at = order[begin + i], face = matches_.face[tile.texels[at]];
        tile.normals[i] = facing::outward_normal(sites_, face);
        tile.origins.point[i] = tile.points[at] + above_ * tile.normals[i];
        tile.origins.face[i] = face;
      }
      tile.origins.place(sites_.frame);
      trace_packet(tile);
      for (std::size_t i = 0; i < tile.origins.count; ++i)
        store(tile.groups, i, tile.texels[order[begin + i]], result);
    }
  }

 private:
  static constexpr double kTilt = 0.3;    // of rays along no axis and in no plane of faces
  static constexpr double kAbove = 1e-6;  // of the diagonal: more than the rounding of points

  /// By rays near a normal, which leave the surface at once: few of them meet anything. The others of a few
  /// tries remain unknown.
  void find_outside(OcclusionTile& tile) const {
    constexpr std::size_t kTries = 4;
    const std::size_t count = tile.origins.count;
    std::uint64_t unknown = count == kMost ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
    for (std::size_t i = 0; i < kTries && unknown != 0; ++i) {
      const int first = std::countr_zero(unknown);
      const Vec3 direction = normalized(tile.normals[first] + kTilt * directions_[i % directions_.size()]);
      std::uint64_t along = 0;
      for (std::size_t k = 0; k < count; ++k)
        along |= std::uint64_t{dot(tile.normals[k], direction) > kTilt} << k;
      rays::find_outside(corners_, tile.origins, direction, along & unknown, tile.stack);
      unknown &= ~(tile.origins.outside | std::uint64_t{1} << first);
    }
  }

  /// One ray along each of the directions or against it, on the outer side of the face.
  void trace_packet(OcclusionTile& tile) const {
    find_outside(tile);
    tile.groups.fill({});
    const std::size_t count = tile.origins.count;
    for (std::size_t i = 0; i < directions_.size(); ++i) {
      const Vec3& direction = directions_[i];
      std::array<float, kMost> cosines;
      std::uint64_t along = 0, against = 0;
      for (std::size_t k = 0; k < count; ++k) {
        const double cosine = dot(tile.normals[k], direction);
        cosines[k] = static_cast<float>(std::abs(cosine));
        along |= std::uint64_t{cosine > 0} << k;
        against |= std::uint64_t{cosine < 0} << k;
      }
      const std::uint64_t met =
          rays::occluded(corners_, tile.origins, direction, max_distance_, along, tile.stack) |
          rays::occluded(corners_, tile.origins, -direction, max_distance_, against, tile.stack);
      RaySums& sums = tile.groups[i * kGroups / directions_.size()];
      for (std::size_t k = 0; k < count; ++k) {
        sums.cosines[k] += cosines[k];
        sums.free[k] += (met >> k & 1) != 0 ? 0 : cosines[k];
      }
    }
  }

  // The estimate is the ratio r = Σ free / Σ cosines; its error is as if groups were independent: its square
  // is the sum of (free − r cosines)² over G groups, times G / (G − 1), by the square of Σ cosines.
  static void store(const std::array<RaySums, kGroups>& groups, std::size_t point, std::uint32_t texel,
                    OcclusionEstimate& result) {
    double cosines = 0, free = 0, squares = 0, used = 0;
    for (const RaySums& sums : groups) {
      cosines += sums.cosines[point];
      free += sums.free[point];
      used += sums.cosines[point] > 0;
    }
    if (!(cosines > 0)) return;
    const double ratio = free / cosines;
    for (const RaySums& sums : groups) {
      const double rest = sums.free[point] - ratio * sums.cosines[point];
      squares += rest * rest;
    }
    result.values[texel] = static_cast<float>(ratio);
    if (used > 1)
      result.standard_errors[texel] = static_cast<float>(std::sqrt(squares * used / (used - 1)) / cosines);
  }

  const sites::SitesData& sites_;
  const TexelMatches& matches_;
  const double above_, max_distance_;
  const rays::LeafCorners corners_;
  std::vector<Vec3> directions_;
};

}  // namespace

OcclusionEstimate matched_occlusion(const Surface& surface, const Sites& sites, const TexelMatches& matches,
                                    const AmbientOcclusionOptions& options) try {
  require_matches(surface, sites, matches);
  check_options(options);
  constexpr std::uint32_t kSide = 64;  // of tiles, in texels
  const sites::SitesData& data = internals(sites);
  require_memory(data.regions.leaves.size() * sizeof(rays::LeafCorners::Leaf),
                 "the ambient occlusion of matches");
  OcclusionEstimate result{baking::no_values(matches, 1, "the ambient occlusion of matches"),
                           baking::no_values(matches, 1, "the errors of ambient occlusion")};
  const OcclusionRays rays(data, matches, options);
  const std::uint32_t width = surface.resolution(), rows = surface.rows();
  const std::uint32_t columns = (width + kSide - 1) / kSide;
  const std::size_t tiles = std::size_t{columns} * ((rows + kSide - 1) / kSide);
  parallel_for(tiles, 1, options.progress, "ambient occlusion", [&](std::size_t begin, std::size_t end) {
    OcclusionTile tile;
    for (std::size_t i = begin; i < end; ++i) {
      const auto left = static_cast<std::uint32_t>(i % columns) * kSide,
                 top = static_cast<std::uint32_t>(i / columns) * kSide;
      tile.texels.clear();
      for (std::uint32_t y = top; y < std::min(rows, top + kSide); ++y)
        for (std::uint32_t x = left; x < std::min(width, left + kSide); ++x)
          if (const std::uint32_t texel = y * width + x;
              matches.face[texel] != kNone && facing::outward_normal(data, matches.face[texel]) != Vec3{})
            tile.texels.push_back(texel);
      rays.trace(tile, result);
    }
  });
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the ambient occlusion of matches");
}

}  // namespace sdm
