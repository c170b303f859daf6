// Sixteen query points that traverse O2 together, each with a bound of its own.
#pragma once

#include <sdm/types.h>

#include <span>
#include <vector>

#include "hierarchy/wide_tree.h"
#include "mesh/regions.h"

namespace sdm {

/// All in the unit frame of O2, in single precision.
struct Packet {
  static constexpr int kSize = 16;

  alignas(64) float position[3][kSize];
  alignas(64) float best[kSize];          ///< squared distance to the closest site so far, for each point
  alignas(64) std::uint32_t face[kSize];  ///< a face of that site, or kNone
  // The points' box, and a sphere around it that also covers the rounding of region tests.
  float lo[3], hi[3], centre[3], radius;
  float bound;  ///< the largest of `best`

  /// Places up to kSize points; the last one fills the lanes left over. `best` and `face` are left to set.
  void place(std::span<const Vec3f> points);
  /// Sets every point's bound to its distance to `seed`, a point of `seed_face`, unless `limit` (squared) is
  /// less.
  void start(float limit, const Vec3f* seed, std::uint32_t seed_face);
};

/// Memory that traversals share, to be kept by a thread.
struct Traversal {
  struct Entry {
    std::uint32_t node, slot;  ///< a child of a wide node
    float bound;               ///< squared distance of its box to the packet's
    float order;               ///< squared distance of its box to the packet's centre
  };
  std::vector<Entry> stack;
};

/// Finds the closest site of each point that is closer than its bound. Chooses the best vector instructions
/// that the machine has, at run time.
void traverse(const WideTree& tree, const Regions& regions, Packet& packet, Traversal& traversal);

}  // namespace sdm
