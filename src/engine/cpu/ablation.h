// Optimisations of the cpu engine that a build can leave out, to measure what each contributes:
// bench/ablation configures with -DSDM_ABLATION=<idea>. All other builds use all of them, and the switches
// cost nothing. Without one of them the maps are the same and only the times differ. See docs/design/cpu.md.
#pragma once

namespace sdm::cpu {

enum class Idea {
  none,           ///< leave nothing out
  convexity,      ///< the bound on candidates from convexity; without: a shell 2 r thick
  regions,        ///< testing candidates by their regions of influence
  groups,         ///< one traversal for a group of packets; without: one for each packet
  large_groups,   ///< groups larger than 64 points
  face_bounds,    ///< bounds of faces; without: all sites of the leaves within reach are collected
  cones,          ///< the cones of these bounds; without: discs only
  short_lists,    ///< evaluating short candidate lists at once; without: they are filtered down to the packet
  last_nearest,   ///< the nearest point of the previous traversal as an initial bound
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
