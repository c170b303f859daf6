// STEP and IGES where no module can be loaded, and no process forked.
#include <fmt/format.h>
#include <sdm/error.h>

#include "io/mesh/formats.h"

namespace sdm::io {
namespace {

[[noreturn]] void refuse(const char* format) {
  throw Error(fmt::format("is {}, which sdm reads on Linux only; convert the file to STL or glTF", format));
}

}  // namespace

bool reads_cad() {
  return false;
}
PolygonMesh read_step(std::string_view, const std::filesystem::path&, const TessellationOptions&) {
  refuse("STEP");
}
PolygonMesh read_iges(std::string_view, const std::filesystem::path&, const TessellationOptions&) {
  refuse("IGES");
}

}  // namespace sdm::io
