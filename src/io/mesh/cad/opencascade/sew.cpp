#include "io/mesh/cad/opencascade/sew.h"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <cmath>
#include <vector>

namespace sdm::io::cad {
namespace {

// Edges that are closer than this share of the diagonal may be one. The deflection is some fifty times as
// large.
constexpr double kGap = 1e-5;

bool has_free_edges(const TopoDS_Shape& whole) {
  TopTools_IndexedDataMapOfShapeListOfShape faces_of_edges;
  TopExp::MapShapesAndAncestors(whole, TopAbs_EDGE, TopAbs_FACE, faces_of_edges);
  for (int i = 1; i <= faces_of_edges.Extent(); ++i) {
    const TopoDS_Edge& edge = TopoDS::Edge(faces_of_edges.FindKey(i));
    const TopTools_ListOfShape& faces = faces_of_edges(i);
    if (faces.Extent() == 1 && !BRep_Tool::Degenerated(edge) &&
        !BRep_Tool::IsClosed(edge, TopoDS::Face(faces.First())))
      return true;
  }
  return false;
}

}  // namespace

void sew(Document& document) try {
  if (!has_free_edges(document.whole)) return;
  Bnd_Box box;
  BRepBndLib::Add(document.whole, box);
  if (box.IsVoid()) return;
  BRepBuilderAPI_Sewing sewing(kGap * std::sqrt(box.SquareExtent()));
  for (const PlacedFace& placed : document.faces) sewing.Add(placed.face);
  sewing.Perform();
  std::vector<TopoDS_Face> faces;
  BRep_Builder builder;
  TopoDS_Compound whole;
  builder.MakeCompound(whole);
  for (const PlacedFace& placed : document.faces) {
    TopoDS_Shape face = placed.face;
    if (sewing.IsModified(face))
      face = sewing.Modified(face);
    else if (sewing.IsModifiedSubShape(face))
      face = sewing.ModifiedSubShape(face);
    if (face.IsNull() || face.ShapeType() != TopAbs_FACE) return;  // divided, or gone
    faces.push_back(TopoDS::Face(face.Oriented(placed.face.Orientation())));
    builder.Add(whole, faces.back());
  }
  for (std::size_t i = 0; i < faces.size(); ++i) document.faces[i].face = faces[i];
  document.whole = whole;
} catch (const Standard_Failure&) {
  // As they were.
}

}  // namespace sdm::io::cad
