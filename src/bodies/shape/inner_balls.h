// Balls inside a solid, as large as they can be at points of its surface.
#pragma once

#include <vector>

#include "bodies/shape/node_ball.h"
#include "inside/inside.h"
#include "sites/sites_data.h"

namespace sdm::shape {

/// Balls and points of a solid, or points of a surface without an inside, in the frame of the mesh.
struct InnerBalls {
  std::vector<Ball> balls;    ///< inside the solid, to 1e-6 of its size, the largest first
  std::vector<Vec3> surface;  ///< points of the surface, spread over it
};

/// Samples the surface at about a hundred points. At each, the ball that touches the surface there from
/// within is made smaller until nothing is in it (Ma, Bae & Choi 2012); of balls that hardly differ, the
/// largest is kept. Cost: some six searches for the closest point for each ball.
[[nodiscard]] InnerBalls inner_balls(const sites::SitesData& sites, const inside::InsideTest& inside);

}  // namespace sdm::shape
