#include "io/mesh/cad/opencascade/document.h"

#include <BRep_Builder.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Interface_Static.hxx>
#include <NCollection_DataMap.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_ExternFile.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPConstruct_ExternRefs.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepShape_Face.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_AsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelMap.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <TransferBRep.hxx>
#include <Transfer_Binder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <filesystem>
#include <istream>
#include <map>
#include <set>
#include <stdexcept>
#include <streambuf>
#include <string_view>
#include <vector>

#include "io/mesh/cad/opencascade/sew.h"

namespace sdm::io::cad {
namespace {

constexpr const char* kDamaged = "OpenCASCADE cannot read it; it is damaged or has another format";

/// Bytes as a stream, without a copy.
class BytesBuffer : public std::streambuf {
 public:
  explicit BytesBuffer(std::string_view bytes) {
    char* const begin = const_cast<char*>(bytes.data());
    setg(begin, begin, begin + bytes.size());
  }
};

/// An open document, which is closed with what it holds.
class OpenDocument {
 public:
  OpenDocument() { XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document); }
  ~OpenDocument() { XCAFApp_Application::GetApplication()->Close(document); }
  OpenDocument(const OpenDocument&) = delete;
  OpenDocument& operator=(const OpenDocument&) = delete;

  Handle(TDocStd_Document) document;
};

/// The names of all units of a file, each once.
std::string unit_names(const TColStd_SequenceOfAsciiString& names) {
  std::string all;
  for (const TCollection_AsciiString& name : names) {
    const std::string one = name.ToCString();
    if (all.find(one) == std::string::npos) all += (all.empty() ? "" : ", ") + one;
  }
  return all;
}

/// Whether the name of a referenced file leads away from the folder of the file that refers to it.
bool leads_elsewhere(const std::filesystem::path& name) {
  return name.is_absolute() || std::ranges::find(name, "..") != name.end() ||
         name.string().find('\\') != std::string::npos;
}

/// A file that a file refers to.
struct Reference {
  std::string name, format;                     ///< the name relative to the folder of the file
  Handle(StepBasic_ProductDefinition) product;  ///< whose shape it has, or which it documents; may be null
};

std::vector<Reference> references_of(const Handle(XSControl_WorkSession) & session) {
  STEPConstruct_ExternRefs references(session);
  references.LoadExternRefs();
  std::vector<Reference> all;
  for (int i = 1; i <= references.NbExternRefs(); ++i) {
    const char* const name = references.FileName(i);
    if (name == nullptr || *name == '\0') continue;
    const Handle(TCollection_HAsciiString) format = references.Format(i);
    all.push_back({.name = name,
                   .format = format.IsNull() ? "" : format->ToCString(),
                   .product = references.ProdDef(i)});
  }
  return all;
}

/// The shape that a session has made of an entity; it may be null.
TopoDS_Shape shape_of(const Handle(XSControl_WorkSession) & session,
                      const Handle(Standard_Transient) & entity) {
  if (entity.IsNull()) return {};
  const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
  const Handle(Transfer_Binder) binder = process.IsNull() ? nullptr : process->Find(entity);
  return binder.IsNull() ? TopoDS_Shape() : TransferBRep::ShapeResult(binder);
}

bool has_content(const TopoDS_Shape& shape) {
  return shape.ShapeType() != TopAbs_COMPOUND || TopoDS_Iterator(shape).More();
}

/// The reader, with what OpenCASCADE leaves out without a word where a file refers to others.
class StepReader : public STEPCAFControl_Reader {
 public:
  /// Reads the shapes, and sets what a document has of files. Throws where a shape would be missing.
  void read(const CadRequest& request, Handle(TDocStd_Document) & document, Document& result) {
    // What else there is, is not used.
    SetLayerMode(false);
    SetPropsMode(false);
    SetGDTMode(false);
    SetMatMode(false);
    SetViewMode(false);
    SetNameMode(request.labels);
    SetColorMode(request.labels);
    // Those of faces are read by name_faces(): OpenCASCADE crashes where shape representations are empty or
    // refer to each other.
    Interface_Static::SetIVal("read.stepcaf.subshapes.name", 0);
    BytesBuffer buffer(request.bytes);
    std::istream stream(&buffer);
    // Names of parts are relative to that of the stream; a relative one would be taken for the current
    // folder.
    const std::filesystem::path file = std::filesystem::absolute(request.file);
    if (ChangeReader().ReadStream(file.c_str(), stream) != IFSelect_RetDone)
      throw std::runtime_error(kDamaged);
    for (const Reference& reference : references_of(ChangeReader().WS()))
      require_beside(reference.name, file.parent_path());
    TDF_LabelSequence roots;
    const bool transferred = Transfer(ChangeReader(), 0, document, roots);
    for (const TDF_Label& root : roots) roots_.Add(root);
    require_references(ChangeReader().WS(), file.parent_path());
    for_each_part([&](const Handle(XSControl_WorkSession) & session) {
      const std::filesystem::path part = session->LoadedFile();
      require_references(session, part.parent_path());
      result.parts.push_back(part);
    });
    if (!transferred) throw std::runtime_error(kDamaged);
    result.documents.assign(documents_.begin(), documents_.end());
  }

  /// Calls visit(entity, session) for all entities of the file and its parts.
  template <class Visit>
  void for_each_entity(const Visit& visit) {
    const auto all_of = [&](const Handle(XSControl_WorkSession) & session) {
      const Handle(Interface_InterfaceModel) model = session->Model();
      for (int i = 1; i <= model->NbEntities(); ++i) visit(model->Value(i), session);
    };
    all_of(ChangeReader().WS());
    for_each_part(all_of);
  }

  /// Whether a shape that nothing contains is one of the file. Others come from parts that are not used, as
  /// the product has a shape of its own. Throws for one that is lost.
  bool is_root(const TDF_Label& label) const {
    if (roots_.Contains(label)) return true;
    for (Files at(ExternFiles()); at.More(); at.Next())
      if (at.Value()->GetLabel() == label && documents_.contains(at.Key().ToCString())) return false;
    throw std::runtime_error("refers to a part that has several shapes, of which only the first has a place");
  }

  /// Documents may have the shape of a part that has none.
  void require_shapes(bool all_have) const {
    if (!all_have && !unattached_.empty())
      throw std::runtime_error("refers to the file " + unattached_ +
                               ", which is not read, and has a part without a shape");
  }

 private:
  using Files = NCollection_DataMap<TCollection_AsciiString, Handle(STEPCAFControl_ExternFile)>::Iterator;

  [[noreturn]] static void refuse(const std::string& name, const char* why) {
    throw std::runtime_error("refers to the part " + name + why);
  }

  static void require_beside(const std::string& name, const std::filesystem::path& folder) {
    if (leads_elsewhere(name)) refuse(name, ", but parts are looked up beside the STEP file only");
    if (const auto path = folder / name; exists(path) && !is_regular_file(path))
      refuse(name, ", which is no regular file");
  }

  /// Visits the parts of the file and of the files that these refer to.
  template <class Visit>
  void for_each_part(const Visit& visit) const {
    for (Files at(ExternFiles()); at.More(); at.Next())
      if (at.Value()->GetLoadStatus() == IFSelect_RetDone) visit(at.Value()->GetWS());
  }

  void require_references(const Handle(XSControl_WorkSession) & session,
                          const std::filesystem::path& folder) {
    for (const Reference& reference : references_of(session)) {
      require_beside(reference.name, folder);
      const TopoDS_Shape shape = shape_of(session, reference.product);
      const bool is_step = reference.format.empty() || reference.format.starts_with("STEP");
      if (!shape.IsNull() && has_content(shape)) {
        documents_.insert(reference.name);
      } else if (!shape.IsNull() && !is_step) {
        refuse(reference.name, ", which is not STEP");
      } else if (is_step) {
        require_part(reference.name, folder);
      } else {
        documents_.insert(reference.name);
        unattached_ = reference.name;
      }
    }
  }

  void require_part(const std::string& name, const std::filesystem::path& folder) {
    Handle(STEPCAFControl_ExternFile) file;
    if (!std::filesystem::exists(folder / name)) refuse(name, ", which is not beside it");
    if (!ExternFile(name.c_str(), file)) refuse(name, ", which was not read");
    if (file->GetLoadStatus() != IFSelect_RetDone) refuse(name, ", which cannot be read as STEP");
    if (!std::filesystem::equivalent(folder / name, file->GetWS()->LoadedFile()))
      refuse(name, ", as one of its parts does, from another folder: such parts are not told apart");
    if (!file->GetTransferStatus() || file->GetLabel().IsNull()) refuse(name, ", which has no shape");
  }

  TDF_LabelMap roots_;
  std::set<std::string> documents_;  ///< files that are not read, or not used
  std::string unattached_;
};

std::string read_iges(const CadRequest& request, Handle(TDocStd_Document) & document) {
  IGESCAFControl_Reader reader;
  reader.SetLayerMode(false);
  reader.SetNameMode(request.labels);
  reader.SetColorMode(request.labels);
  if (reader.ReadFile(request.file) != IFSelect_RetDone) throw std::runtime_error(kDamaged);
  std::string unit;
  if (const auto name = reader.IGESModel()->GlobalSection().UnitName(); !name.IsNull())
    unit = name->ToCString();
  if (!reader.Transfer(document)) throw std::runtime_error(kDamaged);
  return unit;
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (label.IsNull() || !label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  return TCollection_AsciiString(name->Get()).ToCString();
}

using FaceNames = NCollection_DataMap<TopoDS_Shape, std::string, TopTools_ShapeMapHasher>;

/// The names that STEP has of faces, by their shapes without a place.
FaceNames name_faces(StepReader& reader) {
  FaceNames names;
  reader.for_each_entity(
      [&](const Handle(Standard_Transient) & entity, const Handle(XSControl_WorkSession) & session) {
        const Handle(StepShape_Face) face = Handle(StepShape_Face)::DownCast(entity);
        if (face.IsNull() || face->Name().IsNull() || face->Name()->IsEmpty()) return;
        if (const TopoDS_Shape shape = shape_of(session, face); !shape.IsNull())
          names.Bind(shape.Located(TopLoc_Location()), face->Name()->ToCString());
      });
  return names;
}

/// Collects the faces of all instances, from the assemblies down.
class FaceCollector {
 public:
  FaceCollector(const Handle(TDocStd_Document) & document, const FaceNames& names)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())),
        colors_(XCAFDoc_DocumentTool::ColorTool(document->Main())),
        names_(names) {}

  /// is_root() tells which shapes that nothing contains count. Returns whether all parts have shapes.
  template <class IsRoot>
  bool collect(Document& result, const IsRoot& is_root) {
    result_ = &result;
    BRep_Builder builder;
    TopoDS_Compound whole;
    builder.MakeCompound(whole);
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    for (const TDF_Label& root : roots) {
      if (!is_root(root)) continue;
      builder.Add(whole, XCAFDoc_ShapeTool::GetShape(root));
      visit(root, TopLoc_Location(), {}, {});
    }
    result.whole = whole;
    return all_have_shapes_;
  }

 private:
  // `name` and `color`: those that an instance has from the assembly.
  void visit(const TDF_Label& label, const TopLoc_Location& place, const std::string& name,
             const std::string& color) {
    const std::string own = color.empty() ? color_of(label) : color;
    if (XCAFDoc_ShapeTool::IsAssembly(label)) {
      TDF_LabelSequence parts;
      XCAFDoc_ShapeTool::GetComponents(label, parts);
      for (const TDF_Label& part : parts) visit(part, place, {}, own);
    } else if (TDF_Label part; XCAFDoc_ShapeTool::GetReferredShape(label, part)) {
      visit(part, place * XCAFDoc_ShapeTool::GetLocation(label), name_of(label), own);
    } else {
      add_part(label, place, name, own);
    }
  }

  void add_part(const TDF_Label& label, const TopLoc_Location& place, const std::string& instance,
                const std::string& color) {
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    const std::string part = name_of(label);
    const std::uint32_t object = add_object(part.empty() ? instance : part);
    all_have_shapes_ = all_have_shapes_ && has_content(shape);
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
      TDF_Label own;
      const bool has_own = shapes_->FindSubShape(label, face.Current(), own);
      std::string own_color = has_own ? color_of(own) : std::string();
      result_->faces.push_back({.face = TopoDS::Face(face.Current().Moved(place)),
                                .name = name_of_face(face.Current(), own),
                                .color = own_color.empty() ? color : std::move(own_color),
                                .object = object});
    }
  }

  // `own` may be null; those of IGES have names.
  std::string name_of_face(const TopoDS_Shape& face, const TDF_Label& own) const {
    const std::string* const known = names_.Seek(face.Located(TopLoc_Location()));
    return known != nullptr ? *known : name_of(own);
  }

  // Instances of one part are numbered from the second on.
  std::uint32_t add_object(const std::string& name) {
    const std::size_t number = ++instances_[name];
    const std::string shown = name.empty() ? "part" : name;
    result_->objects.push_back(number == 1 ? shown : shown + " (" + std::to_string(number) + ")");
    return static_cast<std::uint32_t>(result_->objects.size() - 1);
  }

  std::string color_of(const TDF_Label& label) const {
    Quantity_Color color;
    for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
      if (colors_->GetColor(label, type, color)) {
        std::string hex = Quantity_Color::ColorToHex(color).ToCString();
        for (char& c : hex)
          if (c >= 'A' && c <= 'F') c = static_cast<char>(c - 'A' + 'a');
        return hex;
      }
    return {};
  }

  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colors_;
  const FaceNames& names_;
  Document* result_ = nullptr;
  bool all_have_shapes_ = true;
  std::map<std::string, std::size_t> instances_;
};

}  // namespace

Document read_document(const CadRequest& request) {
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  OpenDocument open;
  Document result;
  if (request.format == CadFormat::iges) {
    result.unit = read_iges(request, open.document);
    (void)FaceCollector(open.document, {}).collect(result, [](const TDF_Label&) { return true; });
    if (request.labels) sew(result);  // not where a first attempt has crashed
    return result;
  }
  StepReader reader;
  reader.read(request, open.document, result);
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  result.unit = unit_names(lengths);
  const FaceNames names = name_faces(reader);
  reader.require_shapes(FaceCollector(open.document, names).collect(result, [&](const TDF_Label& label) {
    return reader.is_root(label);
  }));
  return result;
}

}  // namespace sdm::io::cad
