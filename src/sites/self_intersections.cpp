#include <sdm/self_intersections.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>
#include <new>
#include <span>

#include "core/cancellation.h"
#include "core/memory.h"
#include "sites/hubs.h"
#include "sites/intersecting_faces.h"
#include "sites/sites_data.h"

namespace sdm {
namespace {

// Calls found(face, face) for each pair of faces that intersect, from any thread, until it returns false.
// Returns false, at any time, if more pairs than `most` come so near each other that they must be tested.
template <class Found>
bool find_intersections(const sites::SitesData& data, std::uint64_t most, const Progress& progress,
                        const Found& found) {
  const sites::FaceSoup mesh{data.mesh.positions, data.mesh.triangles, data.tree};
  std::atomic<std::uint64_t> tested{0};
  sites::for_each_near_pair(data, progress, [&](std::size_t count, std::span<const sites::FacePair> pairs) {
    if (tested.fetch_add(count, std::memory_order_relaxed) + count > most) return false;
    return std::ranges::all_of(pairs, [&](const sites::FacePair& pair) {
      return !faces_intersect(mesh, pair[0], pair[1]) ||
             found(std::min(pair[0], pair[1]), std::max(pair[0], pair[1]));
    });
  });
  return tested <= most;
}

using FacePairs = std::vector<std::array<std::uint32_t, 2>>;

constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();

}  // namespace

std::uint64_t self_intersection_budget(const Sites& sites) {
  constexpr std::uint64_t kLeast = 20'000'000, kOfEachFace = 200;
  return std::max<std::uint64_t>(kLeast, kOfEachFace * sites.mesh().triangles.size());
}

std::optional<FacePairs> self_intersections(const Sites& sites, std::uint64_t most,
                                            const SelfIntersectionOptions& options) try {
  FacePairs pairs;
  std::mutex mutex;
  const bool all =
      find_intersections(internals(sites), most, options.progress, [&](std::uint32_t a, std::uint32_t b) {
        const std::scoped_lock lock(mutex);
        pairs.push_back({a, b});
        return true;
      });
  if (!all) return std::nullopt;
  poll();
  std::ranges::sort(pairs);
  return pairs;
} catch (const std::bad_alloc&) {
  throw out_of_memory("self-intersections");
}

FacePairs self_intersections(const Sites& sites, const SelfIntersectionOptions& options) {
  return *self_intersections(sites, kAll, options);
}

bool is_embedded(const Sites& sites, const SelfIntersectionOptions& options) try {
  std::atomic<bool> embedded{true};
  (void)find_intersections(internals(sites), kAll, options.progress, [&](std::uint32_t, std::uint32_t) {
    embedded = false;
    return false;
  });
  return embedded;
} catch (const std::bad_alloc&) {
  throw out_of_memory("self-intersections");
}

}  // namespace sdm
