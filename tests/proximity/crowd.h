// Bodies of one world, for tests of all their pairs.
#pragma once

#include <sdm/mesh.h>

#include <vector>

#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {

/// Solids of all kinds and a sheet: some intersect, one is inside another, some are far away.
inline std::vector<Mesh> crowd() {
  Mesh shell = sphere(2);
  for (Vec3& p : shell.positions) p = 1.5 * p;
  Mesh sheet{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0.2}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}};
  return {moved(cube(), {0, 0, 0}),
          moved(sphere(2), {1.7, 0.4, 0.3}),
          moved(shell, {6, 0, 0}),
          placed(cube(), "scale:0.3,rotate:10:20:30,translate:6.1:0.1:0"),
          load("cow.off", "fit,scale:2,translate:3.5:1.5:0"),
          load("hand.off", "fit,scale:2,translate:3.6:0.8:0.2"),
          moved(sheet, {0.2, 0.1, 1.6}),
          moved(sphere(2), {40, 3, 2})};
}

}  // namespace sdm::test
