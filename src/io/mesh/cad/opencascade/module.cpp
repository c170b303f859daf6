// The entry of the module libsdm_cad.so.
#include <sdm/version.h>

#include <BRepBndLib.hxx>
#include <Bnd_Box.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Standard_Failure.hxx>
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

std::string read(const CadRequest& request, CadShape& shape, CadClient& client) {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  const Document document = read_document(request);
  if (document.faces.empty()) return "has no faces";
  const double deflection = request.deflection > 0 ? request.deflection : default_deflection(document.whole);
  if (!(deflection > 0) || !std::isfinite(deflection)) return "its faces have no size";
  tessellate(document, deflection, request.angle, shape);
  if (shape.triangles.empty()) return "none of its faces could be tessellated";
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
  } catch (const std::bad_alloc&) {
    shape.fault = "there is not enough memory to read it";
  } catch (const std::exception& failure) {
    shape.fault = failure.what();
  } catch (...) {
    shape.fault = "OpenCASCADE cannot read it";
  }
}
