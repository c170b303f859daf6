// The outline of a chart in the plane, before it is scaled and placed.
#pragma once

#include <sdm/mesh.h>

#include <span>
#include <vector>

#include "atlas/charts/chart.h"
#include "atlas/charts/face_geometry.h"

namespace sdm::atlas {

/// An isometric frame of a chart's plane. Shape coordinates of p: (right·(p − origin), down·(p −
/// origin)) − corner. Seen from outside, `right` points to the right and `down` down: right × down = −axis.
struct ShapeFrame {
  Vec3 origin{}, right{}, down{};
  Vec2 corner{};  ///< brings the lower corner of the chart's bounds to (0, 0)

  [[nodiscard]] Vec2 project(const Vec3& p) const;
};

struct Shape {
  ShapeFrame frame;
  ShapeFrame
      unfolded;  ///< of the second face of an unfolded chart: takes the plane of this face to the chart
  std::vector<std::array<Vec2, 3>> triangles;  ///< shape coordinates of the chart's faces, in their order
  std::uint32_t largest = 0;                   ///< the triangle with the largest area
  /// The directed sides across which the neighbour is not in the chart: closed curves, holes included.
  std::vector<std::array<Vec2, 2>> outline;
  Vec2 size{};                     ///< of the smallest bounding rectangle
  double area = 0, perimeter = 0;  ///< of the projection; that of holes included
};

/// The shapes of charts, each turned so that its smallest bounding rectangle is axis-aligned. Cost: O(n log
/// n), in parallel.
[[nodiscard]] std::vector<Shape> chart_shapes(const Mesh& mesh, const FaceGeometry& faces,
                                              std::span<const Chart> charts);

}  // namespace sdm::atlas
