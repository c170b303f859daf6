// Stands for the gl engine where sdm is built without OpenGL.
#include <sdm/error.h>

#include "engine/gl/gl_engine.h"

namespace sdm {
namespace {

[[noreturn]] void refuse() {
  throw Error(
      "this sdm was built without OpenGL (SDM_BUILD_GL=OFF), which the gl engine needs: use another engine");
}

}  // namespace

std::vector<GlDevice> gl_devices() {
  refuse();
}

GlDevice gl_device(const GlOptions&, std::uint32_t) {
  refuse();
}

RasterWinners gl_winners(const Surface&, const Sites&, const MapOptions&, GlReport&) {
  refuse();
}

}  // namespace sdm
