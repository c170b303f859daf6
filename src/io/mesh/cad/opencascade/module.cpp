// The entry of the module libsdm_cad.so.
#include <sdm/version.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepTools.hxx>
#include <Bnd_Box.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Standard_Failure.hxx>
#include <algorithm>
#include <cmath>
#include <exception>
#include <new>

#include "io/mesh/cad/opencascade/tessellate.h"

namespace sdm::io::cad {
namespace {

double default_deflection(const TopoDS_Shape& whole) {
  Bnd_Box box;
  BRepBndLib::AddOptimal(whole, box, false, false);
  return box.IsVoid() ? 0 : kDefaultDeflection * std::sqrt(box.SquareExtent());
}

/// The number of triangles of faces that are not flat: finer ones have more.
std::size_t curved_triangles(const Document& document, const CadShape& shape) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < shape.faces.size(); ++i) {
    const std::size_t end =
        i + 1 < shape.faces.size() ? shape.faces[i + 1].first_triangle : shape.triangles.size();
    if (BRepAdaptor_Surface(document.faces[i].face, false).GetType() != GeomAbs_Plane)
      count += end - shape.faces[i].first_triangle;
  }
  return count;
}

/// Tessellates anew, from what was as fine as by default.
void refine(const Document& document, const CadRequest& request, CadShape& shape) {
  const double first = shape.deflection;
  const std::size_t curved = curved_triangles(document, shape), flat = shape.triangles.size() - curved;
  if (curved == 0) shape.deflection = request.at_most;  // as fine as any
  if (curved == 0 || flat >= request.most_triangles) return;
  // The number of triangles grows at most as the inverse of the deflection, on faces that are curved twice.
  const double finest =
      first * static_cast<double>(curved) / static_cast<double>(request.most_triangles - flat);
  for (double deflection = std::max(request.at_most, finest); deflection < first; deflection *= 2) {
    BRepTools::Clean(document.whole);
    shape = {};
    tessellate(document, deflection, request.angle, shape);
    if (shape.triangles.size() <= request.most_triangles) return;
  }
  BRepTools::Clean(document.whole);
  shape = {};
  tessellate(document, first, request.angle, shape);
}

std::string read(const CadRequest& request, CadShape& shape, CadClient& client) {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  const Document document = read_document(request);
  if (document.faces.empty()) return "has no faces";
  const double deflection = request.deflection > 0 ? request.deflection : default_deflection(document.whole);
  if (!(deflection > 0) || !std::isfinite(deflection)) return "its faces have no size";
  tessellate(document, deflection, request.angle, shape);
  if (request.deflection == 0 && request.at_most < deflection) refine(document, request, shape);
  if (shape.triangles.empty()) return "none of its faces could be tessellated";
  shape.parts = document.parts;
  shape.documents = document.documents;
  client.tessellated(shape);
  measure(document, shape, client);
  return {};
}

}  // namespace
}  // namespace sdm::io::cad

#define SDM_CAD_EXPORT extern "C" __attribute__((visibility("default")))

SDM_CAD_EXPORT const char* sdm_cad_version() {
  return sdm::kVersion;
}

SDM_CAD_EXPORT void sdm_cad_read(const sdm::io::cad::CadRequest& request, sdm::io::cad::CadShape& shape,
                                 sdm::io::cad::CadClient& client) {
  try {
    shape.fault = sdm::io::cad::read(request, shape, client);
  } catch (const Standard_Failure& failure) {
    shape.fault = std::string("OpenCASCADE cannot read it: ") + failure.DynamicType()->Name();
    shape.is_exception = true;
  } catch (const std::bad_alloc&) {
    shape.fault = "there is not enough memory to read it";
  } catch (const std::exception& failure) {
    shape.fault = failure.what();
  } catch (...) {
    shape.fault = "OpenCASCADE cannot read it";
  }
}
