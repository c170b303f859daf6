// The maps of a frame of `sdm sequence`.
#pragma once

#include <sdm/map.h>

#include <array>

#include "sequence_pair.h"

struct FrameMaps {
  sdm::MapOptions options{};
  std::array<sdm::DistanceMap, 2> of{};  ///< each body, with its distances to the other one

  void compute(const MovingPair& pair, int body) {
    sdm::compute_map(pair.surface(body), pair.sites(1 - body), options, of[body]);
  }
};
