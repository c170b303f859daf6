#include "support/hausdorff_oracle.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <queue>

#include "geometry/triangle.h"
#include "support/oracle.h"

namespace sdm::oracle {

std::array<double, 2> hausdorff_bounds(const Mesh& a, const Mesh& b, double precision) {
  struct Part {
    double upper;
    Corners at;
    bool operator<(const Part& other) const { return upper < other.upper; }
  };
  Mesh faces = b;
  const auto repeats = [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; };
  std::erase_if(faces.triangles, repeats);
  std::priority_queue<Part> parts;
  double lower = 0;
  const auto add = [&](const Corners& at) {
    const Vec3 centre = (1.0 / 3) * (at[0] + at[1] + at[2]);
    double radius = 0;
    for (const Vec3& p : at) radius = std::max(radius, norm(p - centre));
    const double distance = brute_force(faces, centre);
    lower = std::max(lower, distance);
    parts.push({distance + radius, at});
  };
  for (const Triangle& t : a.triangles)
    if (!repeats(t)) add({a.positions[t[0]], a.positions[t[1]], a.positions[t[2]]});
  while (parts.top().upper > lower + precision) {
    const Corners at = parts.top().at;
    parts.pop();
    int longest = 0;
    for (int k = 1; k < 3; ++k)
      if (norm(at[(k + 1) % 3] - at[k]) > norm(at[(longest + 1) % 3] - at[longest])) longest = k;
    const Vec3 &p = at[longest], &q = at[(longest + 1) % 3], &r = at[(longest + 2) % 3];
    const Vec3 middle = 0.5 * (p + q);
    add({p, middle, r});
    add({middle, q, r});
  }
  return {lower, std::max(lower, parts.top().upper)};
}

double exact_distance(const Vec3& point, const std::array<Vec3, 3>& corners) {
  using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
  const auto convert = [](const Vec3& v) { return Exact::Point_3(v[0], v[1], v[2]); };
  const Exact::Point_3 p = convert(point);
  std::array<Exact::Point_3, 3> c{convert(corners[0]), convert(corners[1]), convert(corners[2])};
  Exact::FT squared;
  if (!CGAL::collinear(c[0], c[1], c[2])) {
    squared = CGAL::squared_distance(p, Exact::Triangle_3(c[0], c[1], c[2]));
  } else {
    std::ranges::sort(c);  // along the line
    squared = c[0] == c[2] ? CGAL::squared_distance(p, c[0])
                           : CGAL::squared_distance(p, Exact::Segment_3(c[0], c[2]));
  }
  return std::sqrt(CGAL::to_double(CGAL::exact(squared)));
}

double cgal_hausdorff(const Mesh& a, const Mesh& b, double error) {
  using Surface = CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;
  const auto convert = [](const Mesh& mesh) {
    Surface surface;
    std::vector<Surface::Vertex_index> vertices;
    for (const Vec3& p : mesh.positions) vertices.push_back(surface.add_vertex({p[0], p[1], p[2]}));
    for (const auto& [i, j, k] : mesh.triangles) surface.add_face(vertices[i], vertices[j], vertices[k]);
    return surface;
  };
  return CGAL::Polygon_mesh_processing::bounded_error_Hausdorff_distance<CGAL::Sequential_tag>(
      convert(a), convert(b), error);
}

}  // namespace sdm::oracle
