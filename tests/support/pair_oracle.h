// Distances and intersections of triangles and meshes by CGAL, exactly.
#pragma once

#include <sdm/mesh.h>

#include <memory>

#include "geometry/triangle.h"

namespace sdm::oracle {

/// The distance of two triangles, degenerate ones included: exact, but for the last rounding.
[[nodiscard]] double distance(const Corners& a, const Corners& b);
[[nodiscard]] bool intersect(const Corners& a, const Corners& b);

/// A mesh of triangles with area, to test other triangles against.
class CgalSurface {
 public:
  explicit CgalSurface(const Mesh& mesh);
  ~CgalSurface();
  /// Whether a triangle with area has a point in common with the mesh.
  [[nodiscard]] bool meets(const Corners& triangle) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::oracle
