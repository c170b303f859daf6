// Contacts of vertices with a solid, from its closest points.
#pragma once

#include <sdm/sites.h>

#include <span>
#include <vector>

namespace sdm {

/// A point in a solid, or close above its surface.
struct VertexContact {
  std::uint32_t point = 0;
  Triangle face{};   ///< that the closest point of the surface is on
  Vec3 weights{};    ///< of its corners there
  Vec3 normal{};     ///< length 1: the way out
  double depth = 0;  ///< how far to go along it to be `margin` above the surface, > 0
};

/// Those of the points whose signed distance is below `margin`: closest_points and inside.
[[nodiscard]] std::vector<VertexContact> find_contacts(std::span<const Vec3> points, const Sites& solid,
                                                       double margin);

}  // namespace sdm
