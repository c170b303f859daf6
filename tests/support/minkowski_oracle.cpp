#include "support/minkowski_oracle.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Nef_polyhedron_3.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/convert_nef_polyhedron_to_polygon_mesh.h>
#include <CGAL/minkowski_sum_3.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sdm::oracle {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Solid = CGAL::Nef_polyhedron_3<Kernel>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

// A reflection reverses the faces.
Solid solid_of(const Mesh& mesh, bool reflected) {
  Surface surface;
  std::vector<Surface::Vertex_index> vertices;
  const double sign = reflected ? -1 : 1;
  for (const Vec3& p : mesh.positions)
    vertices.push_back(surface.add_vertex({sign * p[0], sign * p[1], sign * p[2]}));
  for (const auto& [a, b, c] : mesh.triangles)
    surface.add_face(vertices[a], vertices[reflected ? c : b], vertices[reflected ? b : c]);
  return Solid(surface);
}

}  // namespace

double separating_distance(const Mesh& a, const Mesh& b) {
  Solid first = solid_of(b, false), second = solid_of(a, true);
  const Solid difference = CGAL::minkowski_sum_3(first, second);
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> faces;
  CGAL::convert_nef_polyhedron_to_polygon_soup(difference, points, faces, true);
  double least = std::numeric_limits<double>::infinity();
  const Kernel::Point_3 origin(0, 0, 0);
  for (const std::vector<std::size_t>& f : faces) {
    const Kernel::Triangle_3 triangle(points[f[0]], points[f[1]], points[f[2]]);
    if (triangle.is_degenerate()) continue;
    least = std::min(least, CGAL::to_double(CGAL::squared_distance(origin, triangle)));
  }
  return std::sqrt(least);
}

}  // namespace sdm::oracle
