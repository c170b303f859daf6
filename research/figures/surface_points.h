// Random points of a surface with their exact distances: to measure errors between samples.
#pragma once

#include <sdm/sites.h>

#include <cstddef>
#include <vector>

namespace sdm::figures {

struct SurfacePoints {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> faces;  ///< of each point
  std::vector<double> distances;     ///< to the sites, unsigned, by the reference engine
};

/// Points distributed evenly over the area of a mesh; the same on every run.
[[nodiscard]] SurfacePoints surface_points(const Mesh& mesh, const Sites& sites, std::size_t count);

}  // namespace sdm::figures
