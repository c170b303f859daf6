#include <sdm/self_intersections.h>

#include <algorithm>
#include <atomic>
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
// Returns whether no pair was left out because more than `most` come so near each other that they must be
// tested.
template <class Found>
bool find_intersections(const sites::SitesData& data, std::uint64_t most, const Progress& progress,
                        const Found& found) {
  const sites::FaceSoup mesh{data.mesh.positions, data.mesh.triangles, data.tree};
  return sites::for_each_near_pair(data, most, progress, [&](std::span<const sites::FacePair> pairs) {
    return std::ranges::all_of(pairs, [&](const sites::FacePair& pair) {
      return !faces_intersect(mesh, pair[0], pair[1]) ||
             found(std::min(pair[0], pair[1]), std::max(pair[0], pair[1]));
    });
  });
}

using FacePairs = std::vector<std::array<std::uint32_t, 2>>;

}  // namespace

std::uint64_t self_intersection_budget(const Sites& sites) {
  constexpr std::uint64_t kLeast = 2'000'000, kOfEachFace = 200;
  return std::max<std::uint64_t>(kLeast, kOfEachFace * sites.mesh().triangles.size());
}

SelfIntersections self_intersections(const Sites& sites, std::uint64_t most,
                                     const SelfIntersectionOptions& options) try {
  SelfIntersections found;
  std::mutex mutex;
  found.all =
      find_intersections(internals(sites), most, options.progress, [&](std::uint32_t a, std::uint32_t b) {
        const std::scoped_lock lock(mutex);
        found.pairs.push_back({a, b});
        return true;
      });
  poll();
  std::ranges::sort(found.pairs);
  return found;
} catch (const std::bad_alloc&) {
  throw out_of_memory("self-intersections");
}

FacePairs self_intersections(const Sites& sites, const SelfIntersectionOptions& options) {
  return self_intersections(sites, sites::kAllPairs, options).pairs;
}

bool is_embedded(const Sites& sites, const SelfIntersectionOptions& options) try {
  std::atomic<bool> embedded{true};
  (void)find_intersections(internals(sites), sites::kAllPairs, options.progress,
                           [&](std::uint32_t, std::uint32_t) {
                             embedded = false;
                             return false;
                           });
  return embedded;
} catch (const std::bad_alloc&) {
  throw out_of_memory("self-intersections");
}

}  // namespace sdm
