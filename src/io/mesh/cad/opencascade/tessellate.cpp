#include "io/mesh/cad/opencascade/tessellate.h"

#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <IMeshTools_Parameters.hxx>
#include <NCollection_DataMap.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>

namespace sdm::io::cad {
namespace {

constexpr std::uint32_t kNew = 0xFFFFFFFFu;

template <class Value>
using ShapeMap = NCollection_DataMap<TopoDS_Shape, Value, TopTools_ShapeMapHasher>;

/// Numbers the vertices of the triangles: the nodes of a face that lie on an edge, or at a corner, have the
/// numbers that the first face there gave them.
class Joiner {
 public:
  explicit Joiner(CadShape& shape) : shape_(shape) {}

  void add(const TopoDS_Face& face) {
    TopLoc_Location place;
    const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face, place);
    if (triangles.IsNull()) return;
    numbers_.assign(static_cast<std::size_t>(triangles->NbNodes()) + 1, kNew);
    for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next())
      join_edge(TopoDS::Edge(edge.Current()), triangles, place);
    const bool reversed = face.Orientation() == TopAbs_REVERSED;
    for (int t = 1; t <= triangles->NbTriangles(); ++t) {
      int a = 0, b = 0, c = 0;
      triangles->Triangle(t).Get(a, b, c);
      if (reversed) std::swap(b, c);
      add_triangle({number(a, triangles, place), number(b, triangles, place), number(c, triangles, place)});
    }
  }

 private:
  // Nodes at the pole of a sphere are one vertex.
  void add_triangle(const std::array<std::uint32_t, 3>& t) {
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) shape_.triangles.push_back(t);
  }

  std::uint32_t number(int node, const Handle(Poly_Triangulation) & triangles, const TopLoc_Location& place) {
    std::uint32_t& known = numbers_[static_cast<std::size_t>(node)];
    if (known == kNew) {
      const gp_Pnt p = triangles->Node(node).Transformed(place.Transformation());
      known = static_cast<std::uint32_t>(shape_.positions.size());
      shape_.positions.push_back({p.X(), p.Y(), p.Z()});
    }
    return known;
  }

  // A node keeps its number where both pieces of a seam meet in a corner.
  void join(int node, std::uint32_t& shared, const Handle(Poly_Triangulation) & triangles,
            const TopLoc_Location& place) {
    std::uint32_t& known = numbers_[static_cast<std::size_t>(node)];
    if (shared == kNew) shared = number(node, triangles, place);
    if (known == kNew) known = shared;
  }

  void join_edge(const TopoDS_Edge& edge, const Handle(Poly_Triangulation) & triangles,
                 const TopLoc_Location& place) {
    const Handle(Poly_PolygonOnTriangulation) polygon =
        BRep_Tool::PolygonOnTriangulation(edge, triangles, place);
    if (polygon.IsNull()) return;
    const int count = polygon->NbNodes();
    const bool point = BRep_Tool::Degenerated(edge);
    const TopoDS_Vertex first = TopExp::FirstVertex(edge), last = TopExp::LastVertex(edge);
    for (int i = 1; i <= count; ++i) {
      const TopoDS_Vertex& corner = i == 1 || point ? first : last;
      if ((i == 1 || i == count || point) && !corner.IsNull()) {
        join(polygon->Node(i), *of_corner(corner), triangles, place);
      } else {
        std::vector<std::uint32_t>& nodes = of_edge(edge, static_cast<std::size_t>(count));
        if (nodes.size() == static_cast<std::size_t>(count))
          join(polygon->Node(i), nodes[static_cast<std::size_t>(i - 1)], triangles, place);
      }
    }
  }

  std::uint32_t* of_corner(const TopoDS_Vertex& corner) {
    if (std::uint32_t* known = corners_.ChangeSeek(corner)) return known;
    return corners_.Bound(corner, kNew);
  }

  std::vector<std::uint32_t>& of_edge(const TopoDS_Edge& edge, std::size_t count) {
    if (std::vector<std::uint32_t>* known = edges_.ChangeSeek(edge)) return *known;
    return *edges_.Bound(edge, std::vector<std::uint32_t>(count, kNew));
  }

  CadShape& shape_;
  std::vector<std::uint32_t> numbers_;  // of the nodes of a face, which count from 1
  ShapeMap<std::uint32_t> corners_;
  ShapeMap<std::vector<std::uint32_t>> edges_;
};

}  // namespace

void tessellate(const Document& document, double deflection, double angle, CadShape& shape) {
  IMeshTools_Parameters parameters;
  parameters.Deflection = deflection;
  parameters.Angle = angle;
  parameters.InParallel = false;  // oneTBB would wait for threads that a forked process does not have
  BRepMesh_IncrementalMesh(document.whole, parameters);
  shape.deflection = deflection;
  shape.objects = document.objects;
  shape.unit = document.unit;
  Joiner joiner(shape);
  for (const PlacedFace& placed : document.faces) {
    const std::size_t first = shape.triangles.size();
    joiner.add(placed.face);
    if (shape.triangles.size() == first) ++shape.omitted_faces;
    shape.faces.push_back(
        {.name = placed.name, .color = placed.color, .object = placed.object, .first_triangle = first});
  }
}

}  // namespace sdm::io::cad
