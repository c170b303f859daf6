// Ideas of the cpu engine that a build can leave out, to measure what each contributes: bench/ablation
// configures with -DSDM_ABLATION=<idea>. Every other build uses all of them, at no cost. Maps are the same
// without any of them; only their times differ. See docs/design/cpu.md.
#pragma once

namespace sdm::cpu {

enum class Idea {
  none,           ///< as a value of SDM_ABLATION: leave nothing out
  convexity,      ///< the bound on candidates that follows from convexity; without: a shell 2 r thick
  regions,        ///< regions of influence as a test of candidates
  groups,         ///< traversals for groups of packets; without: one for each packet
  large_groups,   ///< groups larger than 64 points
  face_bounds,    ///< bounds of faces; without: all sites of a leaf within reach are gathered
  cones,          ///< the cones of these bounds; without: discs only
  short_lists,    ///< evaluating short lists at once; without: they are filtered down to the packet
  last_nearest,   ///< the nearest point of the previous traversal as a first bound
  packed_finish,  ///< distances in double for many points of a site at once; without: a walk for each point
};

#ifdef SDM_ABLATION
inline constexpr Idea kLeftOut = Idea::SDM_ABLATION;
#else
inline constexpr Idea kLeftOut = Idea::none;
#endif

constexpr bool uses(Idea idea) {
  return idea != kLeftOut;
}

}  // namespace sdm::cpu
