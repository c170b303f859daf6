// Pairs of meshes whose matches brute force can find.
#pragma once

#include <sdm/mesh.h>

#include <random>
#include <vector>

#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {

struct MatchPair {
  Mesh o1, o2;
};

/// Closed, open, smooth and sharp meshes, in several poses: 40 pairs.
inline std::vector<MatchPair> pairs_to_match() {
  const std::vector<Mesh> firsts{sphere(1), torus(8, 6), cube(0.8), height_field(4), tetrahedron()};
  const std::vector<Mesh> seconds{placed(sphere(1), "scale:1.1"), torus(9, 7), cube(0.75),
                                  joined(cube(0.7), placed(sphere(1), "translate:0.3:0.2:0.1"))};
  std::vector<MatchPair> pairs;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-0.15, 0.15);
  for (const Mesh& o1 : firsts)
    for (const Mesh& o2 : seconds)
      for (const char* turn : {"rotate:0.1:0.2:0.3", "rotate:10:20:30"})
        pairs.push_back({o1, moved(placed(o2, turn), {any(random), any(random), any(random)})});
  return pairs;
}

}  // namespace sdm::test
