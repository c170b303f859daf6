// Thin-walled parts, built in code.
#pragma once

#include <sdm/mesh.h>

#include <string>
#include <vector>

namespace sdm::bench {

inline constexpr double kWall = 0.02;

/// A cup of radius 1 and height 2; 1,536 triangles.
[[nodiscard]] Mesh cup();
/// A sphere of 1,280 triangles with a cavity of as many.
[[nodiscard]] Mesh hollow_sphere(double radius);

struct ThinPart {
  std::string name;
  Mesh mesh;
};

/// Ten solids about 2 wide, whose walls are 0.02 thick: cup, hollow sphere, tube, bowl, funnel, vase, flanged
/// pipe, hollow ring, corrugated sheet and square tray.
[[nodiscard]] std::vector<ThinPart> thin_parts();

}  // namespace sdm::bench
