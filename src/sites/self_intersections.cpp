#include <sdm/self_intersections.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <new>

#include "core/memory.h"
#include "core/parallel.h"
#include "sites/intersecting_faces.h"
#include "sites/sites_data.h"

namespace sdm {
namespace {

using hierarchy::NodePair;

// Pairs of nodes that together cover all pairs whose boxes overlap: enough of them to share among threads.
std::vector<NodePair> starting_pairs(const hierarchy::AabbTree& tree) {
  constexpr std::size_t kEnough = 512;
  std::vector<NodePair> pairs{{0, 0}};
  for (std::size_t before = 0; pairs.size() < kEnough && pairs.size() != before;) {
    before = pairs.size();
    std::vector<NodePair> next;
    for (const NodePair& pair : pairs) {
      if (tree.nodes[pair[0]].leaf() && tree.nodes[pair[1]].leaf())
        next.push_back(pair);
      else
        for_each_child_pair(tree, pair, [&](const NodePair& below) {
          if (sites::overlap(tree, below)) next.push_back(below);
        });
    }
    pairs = std::move(next);
  }
  return pairs;
}

// Calls found(face, face) for each pair of faces that intersect, from any thread, until it returns false.
template <class Found>
void find_intersections(const sites::SitesData& data, const Progress& progress, const Found& found) {
  const hierarchy::AabbTree& tree = data.tree;
  if (tree.nodes.empty()) return;
  const sites::FaceSoup mesh{data.mesh.positions, data.mesh.triangles, tree};
  const std::vector<NodePair> pairs = starting_pairs(tree);
  std::atomic<bool> go_on{true};
  parallel_for(pairs.size(), 1, progress, "self-intersections", [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      traverse_pairs(
          tree, pairs[i],
          [&](const NodePair& pair) {
            return go_on.load(std::memory_order_relaxed) && sites::overlap(tree, pair);
          },
          [&](const NodePair& leaves) {
            sites::for_each_face_pair(tree, leaves, [&](std::uint32_t a, std::uint32_t b) {
              if (faces_intersect(mesh, a, b) && !found(std::min(a, b), std::max(a, b))) go_on = false;
            });
          });
  });
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> self_intersections(const Sites& sites,
                                                             const Progress& progress) try {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  std::mutex mutex;
  find_intersections(internals(sites), progress, [&](std::uint32_t a, std::uint32_t b) {
    const std::scoped_lock lock(mutex);
    pairs.push_back({a, b});
    return true;
  });
  std::ranges::sort(pairs);
  return pairs;
} catch (const std::bad_alloc&) {
  throw out_of_memory("self-intersections");
}

bool is_embedded(const Sites& sites, const Progress& progress) try {
  std::atomic<bool> embedded{true};
  find_intersections(internals(sites), progress, [&](std::uint32_t, std::uint32_t) {
    embedded = false;
    return false;
  });
  return embedded;
} catch (const std::bad_alloc&) {
  throw out_of_memory("self-intersections");
}

}  // namespace sdm
