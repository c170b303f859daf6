// Maps and proximity queries of two deforming bodies, frame by frame: what Figures 3 and 7 have in common.
#pragma once

#include "research/figures/figure.h"
#include "research/figures/run.h"
#include "research/figures/timing.h"

namespace sdm::figures {

struct Deforming {
  std::size_t triangles[2] = {}, texels = 0, frames = 0;
  /// Of each frame: moving the vertices; the maps in both directions, by the cpu engine; separation,
  /// collision, penetration depth and contacts.
  Times update{}, maps{}, queries{};
  Times gl_maps{};                            ///< of some frames, by the gl engine
  std::vector<double> separation{}, depth{};  ///< of each frame, in m
  std::size_t colliding = 0;                  ///< frames
  double error = 0;                           ///< at the samples of the frame shown, relative to the diagonal
  double gl_error = 0;                        ///< likewise
  std::size_t shown = 0;  ///< the frame of the pictures of maps: the first with a collision, else the closest
};

/// Runs all frames with maps of resolution² texels.
[[nodiscard]] Deforming run_frames(Run& run, const Recording& recording, std::uint32_t resolution);

/// Two frames of the bodies, the maps of the second, and the separation over time; `figure` has its texts.
void show_frames(Figure& figure, const Recording& recording, const Deforming& result,
                 std::uint32_t resolution, bool directions);

[[nodiscard]] Json measured_json(const Run& run, const Deforming& result, std::uint32_t resolution);

}  // namespace sdm::figures
