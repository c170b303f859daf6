// Writes CAD files whose shapes are known: make_cad FOLDER. A program of its own, since tests do not link
// OpenCASCADE.
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Shape.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cstdio>
#include <gp_Ax2.hxx>
#include <string>

namespace {

void require(bool done, const std::string& what) {
  if (done) return;
  std::fprintf(stderr, "make_cad: %s\n", what.c_str());
  std::exit(1);
}

Handle(TDocStd_Document) new_document() {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  return document;
}

void write_step(const Handle(TDocStd_Document) & document, const std::string& file, const char* unit) {
  STEPCAFControl_Writer writer;
  Interface_Static::SetCVal("write.step.unit", unit);
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  require(writer.Transfer(document, STEPControl_AsIs) && writer.Write(file.c_str()) == IFSelect_RetDone,
          file);
}

void write_step(const TopoDS_Shape& shape, const std::string& name, const std::string& file,
                const char* unit = "MM") {
  const Handle(TDocStd_Document) document = new_document();
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  TDataStd_Name::Set(shapes->AddShape(shape, false), name.c_str());
  write_step(document, file, unit);
}

enum class Iges { surfaces, solids };
void write_iges(const TopoDS_Shape& shape, const std::string& file, Iges as) {
  IGESControl_Writer writer("IN", as == Iges::solids ? 1 : 0);
  require(writer.AddShape(shape), file);
  writer.ComputeModel();
  require(writer.Write(file.c_str()), file);
}

// Two instances of a plate of 2 × 1 × 0.5 inches, 10 inches apart, with a red top named "datum A". The writer
// declares the unit, and leaves the numbers as they are.
void write_assembly(const std::string& file) {
  const Handle(TDocStd_Document) document = new_document();
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const Handle(XCAFDoc_ColorTool) colors = XCAFDoc_DocumentTool::ColorTool(document->Main());
  BRepPrimAPI_MakeBox box(2, 1, 0.5);
  const TDF_Label plate = shapes->AddShape(box.Shape(), false);
  TDataStd_Name::Set(plate, "plate");
  colors->SetColor(plate, Quantity_Color(0, 0, 1, Quantity_TOC_RGB), XCAFDoc_ColorSurf);
  const TDF_Label top = shapes->AddSubShape(plate, box.TopFace());
  TDataStd_Name::Set(top, "datum A");
  colors->SetColor(top, Quantity_Color(1, 0, 0, Quantity_TOC_RGB), XCAFDoc_ColorSurf);
  const TDF_Label assembly = shapes->NewShape();
  TDataStd_Name::Set(assembly, "stack");
  gp_Trsf far;
  far.SetTranslation(gp_Vec(0, 0, 10));
  shapes->AddComponent(assembly, plate, TopLoc_Location());
  shapes->AddComponent(assembly, plate, TopLoc_Location(far));
  shapes->UpdateAssemblies();
  write_step(document, file, "INCH");
}

// Two parts that nothing joins.
void write_two(const std::string& file) {
  const Handle(TDocStd_Document) document = new_document();
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  for (const double size : {1.0, 2.0}) shapes->AddShape(BRepPrimAPI_MakeBox(size, size, size).Shape(), false);
  write_step(document, file, "MM");
}

// Two instances of a part of 1 × 2 × 3, 5 apart, in a file of its own.
void write_external(const std::string& file) {
  const Handle(TDocStd_Document) document = new_document();
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const TDF_Label part = shapes->AddShape(BRepPrimAPI_MakeBox(1, 2, 3).Shape(), false);
  TDataStd_Name::Set(part, "part");
  const TDF_Label assembly = shapes->NewShape();
  TDataStd_Name::Set(assembly, "assembly");
  gp_Trsf far;
  far.SetTranslation(gp_Vec(5, 0, 0));
  shapes->AddComponent(assembly, part, TopLoc_Location());
  shapes->AddComponent(assembly, part, TopLoc_Location(far));
  shapes->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  Interface_Static::SetCVal("write.step.unit", "MM");
  require(writer.Transfer(document, STEPControl_AsIs, "external_") &&
              writer.Write(file.c_str()) == IFSelect_RetDone,
          file);
}

}  // namespace

int main(int count, char** arguments) {
  require(count == 2, "a folder is needed");
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  const std::string folder = std::string(arguments[1]) + "/";
  const TopoDS_Shape cylinder = BRepPrimAPI_MakeCylinder(10, 30).Shape();
  const TopoDS_Shape bore = BRepPrimAPI_MakeCylinder(8, 30).Shape();
  const TopoDS_Shape tube = BRepAlgoAPI_Cut(cylinder, bore).Shape();
  write_step(BRepPrimAPI_MakeBox(10, 20, 30).Shape(), "box", folder + "box.step");
  write_step(cylinder, "cylinder", folder + "cylinder.step");
  write_step(tube, "tube", folder + "tube.step");
  write_step(BRepPrimAPI_MakeSphere(10).Shape(), "sphere", folder + "sphere.step");
  write_step(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(1, 0, 0)).Shape(), "line", folder + "line.step");
  write_iges(tube, folder + "tube.igs", Iges::solids);
  write_iges(tube, folder + "surfaces.igs", Iges::surfaces);
  write_two(folder + "two.step");
  write_assembly(folder + "assembly.step");
  write_external(folder + "external.step");
}
