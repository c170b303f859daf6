// Replaces the gl engine in builds without OpenGL.
#include <sdm/error.h>
#include <sdm/gl.h>

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

GlDevice gl_device(std::uint32_t, const GlOptions&) {
  refuse();
}

std::shared_ptr<const Engine> make_gl_engine(const GlOptions&) {
  refuse();
}

std::optional<GlReport> gl_report(const Engine&) {
  return std::nullopt;
}

}  // namespace sdm
