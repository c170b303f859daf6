// The distance from exact surfaces to their triangles, at points inside each triangle and on each edge.
#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRep_Tool.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>

#include "geometry/point_triangle.h"
#include "io/mesh/cad/opencascade/tessellate.h"

namespace sdm::io::cad {
namespace {

Vec3 vec(const gp_Pnt& p) {
  return {p.X(), p.Y(), p.Z()};
}

/// The largest distance so far. The distance to the triangle that a point of the surface was taken from
/// bounds its distance to all triangles, so that few points need the latter.
class Largest {
 public:
  Largest(CadShape& shape, CadClient& client) : shape_(shape), client_(client) {}

  void add(const Vec3& point, const Corners& own) {
    ++shape_.measured_points;
    constexpr double kMore = 1 + 1e-6;  // equal distances of a cylinder differ by rounding
    const double bound = std::sqrt(closest_feature(point, own, true).squared);
    if (std::isfinite(bound) && bound > kMore * shape_.largest_deviation)
      shape_.largest_deviation = std::max(shape_.largest_deviation, client_.distance(point));
  }

 private:
  CadShape& shape_;
  CadClient& client_;
};

// Measures parametric triangles, whose union is the face but for strips along its edges.
void measure_surface(const TopoDS_Face& face, Largest& largest) {
  constexpr int kParts = 4;  // of each side
  TopLoc_Location place;
  const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face, place);
  if (triangles.IsNull() || !triangles->HasUVNodes()) return;
  const BRepAdaptor_Surface surface(face, false);
  if (surface.GetType() == GeomAbs_Plane) return;
  for (int t = 1; t <= triangles->NbTriangles(); ++t) {
    int node[3];
    triangles->Triangle(t).Get(node[0], node[1], node[2]);
    Corners corners;
    gp_XY uv[3];
    for (int k = 0; k < 3; ++k) {
      corners[k] = vec(triangles->Node(node[k]).Transformed(place.Transformation()));
      uv[k] = triangles->UVNode(node[k]).XY();
    }
    for (int i = 0; i < kParts; ++i)
      for (int j = 0; i + j <= kParts; ++j) {
        if (j == kParts || (i == 0 && j == 0)) continue;  // a corner
        const gp_XY at = (uv[0] * i + uv[1] * j + uv[2] * (kParts - i - j)) / kParts;
        largest.add(vec(surface.Value(at.X(), at.Y())), corners);
      }
  }
}

// Measures the curves of the edges, between the nodes on them.
void measure_edges(const TopoDS_Face& face, Largest& largest) {
  constexpr int kParts = 4;
  TopLoc_Location place;
  const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face, place);
  if (triangles.IsNull()) return;
  for (TopExp_Explorer at(face, TopAbs_EDGE); at.More(); at.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(at.Current());
    if (BRep_Tool::Degenerated(edge)) continue;
    const Handle(Poly_PolygonOnTriangulation) polygon =
        BRep_Tool::PolygonOnTriangulation(edge, triangles, place);
    if (polygon.IsNull() || !polygon->HasParameters()) continue;
    const BRepAdaptor_Curve curve(edge);
    if (curve.GetType() == GeomAbs_Line) continue;
    const auto node = [&](int i) {
      return vec(triangles->Node(polygon->Node(i)).Transformed(place.Transformation()));
    };
    for (int i = 1; i < polygon->NbNodes(); ++i)
      for (int k = 1; k < kParts; ++k) {
        const double t =
            polygon->Parameter(i) + (polygon->Parameter(i + 1) - polygon->Parameter(i)) * k / kParts;
        largest.add(vec(curve.Value(t)), {node(i), node(i), node(i + 1)});
      }
  }
}

}  // namespace

void measure(const Document& document, CadShape& shape, CadClient& client) {
  Largest largest(shape, client);
  for (const PlacedFace& placed : document.faces) {
    measure_surface(placed.face, largest);
    measure_edges(placed.face, largest);
  }
}

}  // namespace sdm::io::cad
