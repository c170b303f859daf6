#include "io/mesh/cad/opencascade/document.h"

#include <BRep_Builder.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_ExternFile.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPConstruct_ExternRefs.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_AsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <filesystem>
#include <istream>
#include <map>
#include <stdexcept>
#include <streambuf>
#include <string_view>
#include <vector>

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

[[noreturn]] void throw_elsewhere(const std::string& name) {
  throw std::runtime_error("refers to the part " + name +
                           ", but parts are looked up beside the STEP file only");
}

/// The parts of an assembly that are files of their own, as the reader will look them up: by names relative
/// to the folder of the file. Those of other formats than STEP are documents.
std::vector<std::string> referenced_files(const STEPCAFControl_Reader& reader) {
  STEPConstruct_ExternRefs references(reader.Reader().WS());
  references.LoadExternRefs();
  std::vector<std::string> names;
  for (int i = 1; i <= references.NbExternRefs(); ++i) {
    const char* const name = references.FileName(i);
    const Handle(TCollection_HAsciiString) format = references.Format(i);
    if (name == nullptr || *name == '\0') continue;
    if (!format.IsNull() && std::string_view(format->ToCString()).substr(0, 4) != "STEP") continue;
    names.emplace_back(name);
  }
  return names;
}

/// What OpenCASCADE leaves out without a word.
void require_references(const STEPCAFControl_Reader& reader, const std::vector<std::string>& names,
                        const std::filesystem::path& folder) {
  for (NCollection_DataMap<TCollection_AsciiString, Handle(STEPCAFControl_ExternFile)>::Iterator at(
           reader.ExternFiles());
       at.More(); at.Next()) {  // with those that parts refer to
    const std::string name = at.Key().ToCString();
    if (leads_elsewhere(name)) throw_elsewhere(name);
    if (at.Value()->GetLoadStatus() != IFSelect_RetDone)
      throw std::runtime_error("refers to the part " + name +
                               ", which is not beside it, or cannot be read as STEP");
    if (!at.Value()->GetTransferStatus())
      throw std::runtime_error("refers to the part " + name + ", which has no shape");
  }
  for (const std::string& name : names)
    if (!reader.ExternFiles().IsBound(name.c_str()))
      throw std::runtime_error("refers to the part " + (folder / name).string() + ", which was not read");
}

/// The paths of the files that it has read, with those that parts refer to.
std::vector<std::string> parts_read(const STEPCAFControl_Reader& reader) {
  std::vector<std::string> files;
  for (NCollection_DataMap<TCollection_AsciiString, Handle(STEPCAFControl_ExternFile)>::Iterator at(
           reader.ExternFiles());
       at.More(); at.Next())
    files.emplace_back(at.Value()->GetWS()->LoadedFile());
  return files;
}

std::string read_step(const CadRequest& request, Handle(TDocStd_Document) & document,
                      std::vector<std::string>& parts_of_file) {
  STEPCAFControl_Reader reader;
  Interface_Static::SetIVal("read.stepcaf.subshapes.name", 1);
  BytesBuffer buffer(request.bytes);
  std::istream stream(&buffer);
  // Names of parts are relative to that of the stream; a relative one would be taken for the current folder.
  const std::filesystem::path file = std::filesystem::absolute(request.file);
  if (reader.ChangeReader().ReadStream(file.c_str(), stream) != IFSelect_RetDone)
    throw std::runtime_error(kDamaged);
  const std::vector<std::string> parts = referenced_files(reader);
  for (const std::string& name : parts) {
    if (leads_elsewhere(name)) throw_elsewhere(name);
    if (!std::filesystem::is_regular_file(file.parent_path() / name))
      throw std::runtime_error("refers to the part " + name + ", which is not beside it");
  }
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  const bool transferred = reader.Transfer(document);
  require_references(reader, parts, file.parent_path());
  if (!transferred) throw std::runtime_error(kDamaged);
  parts_of_file = parts_read(reader);
  return unit_names(lengths);
}

std::string read_iges(const CadRequest& request, Handle(TDocStd_Document) & document) {
  IGESCAFControl_Reader reader;
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

/// Collects the faces of all instances, from the assemblies down.
class FaceCollector {
 public:
  explicit FaceCollector(const Handle(TDocStd_Document) & document)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())),
        colors_(XCAFDoc_DocumentTool::ColorTool(document->Main())) {}

  void collect(Document& result) {
    result_ = &result;
    BRep_Builder builder;
    TopoDS_Compound whole;
    builder.MakeCompound(whole);
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    for (const TDF_Label& root : roots) {
      builder.Add(whole, XCAFDoc_ShapeTool::GetShape(root));
      visit(root, TopLoc_Location(), {}, {});
    }
    result.whole = whole;
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
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
      TDF_Label own;
      const bool has_own = shapes_->FindSubShape(label, face.Current(), own);
      std::string own_color = has_own ? color_of(own) : std::string();
      result_->faces.push_back({.face = TopoDS::Face(face.Current().Moved(place)),
                                .name = has_own ? name_of(own) : std::string(),
                                .color = own_color.empty() ? color : std::move(own_color),
                                .object = object});
    }
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
  Document* result_ = nullptr;
  std::map<std::string, std::size_t> instances_;
};

}  // namespace

Document read_document(const CadRequest& request) {
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  OpenDocument open;
  Document result;
  result.unit = request.format == CadFormat::step ? read_step(request, open.document, result.parts)
                                                  : read_iges(request, open.document);
  FaceCollector(open.document).collect(result);
  return result;
}

}  // namespace sdm::io::cad
