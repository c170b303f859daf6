// Devices that fail during a map: the error is one sentence, and the next map works.
#include <gmock/gmock.h>
#include <sdm/sdm.h>

#include <cstring>
#include <vector>

#include "gl/replaced.h"
#include "gl/support.h"
#include "support/error_of.h"
#include "support/map_checks.h"
#include "support/meshes.h"

namespace sdm {
namespace {

using test::Replaced;
using ::testing::HasSubstr;

class DeviceFailure : public testing::TestWithParam<GlClip> {
 protected:
  [[nodiscard]] test::GlMap map() const { return test::gl_map(surface_, sites_, {.clip = GetParam()}); }
  void SetUp() override { expected_ = map().distance; }
  void TearDown() override {
    const std::vector<float> after = map().distance;
    ASSERT_EQ(after.size(), expected_.size());
    EXPECT_EQ(std::memcmp(after.data(), expected_.data(), after.size() * sizeof(float)), 0);
  }

  Surface surface_{test::load("cow.off", "fit"), {.resolution = 64}};
  Sites sites_{test::load("head.off", "fit,translate:0.5:0:0")};
  std::vector<float> expected_;
};
INSTANTIATE_TEST_SUITE_P(Clips, DeviceFailure, testing::Values(GlClip::planes, GlClip::stencil),
                         [](const auto& clip) {
                           return std::string(clip.param == GlClip::planes ? "planes" : "stencil");
                         });

TEST_P(DeviceFailure, ResetWhileDrawing) {
  const Replaced reset(epoxy_glGetGraphicsResetStatus,
                       PFNGLGETGRAPHICSRESETSTATUSPROC([]() -> GLenum { return GL_GUILTY_CONTEXT_RESET; }));
  EXPECT_THAT(test::error_of([&] { return map(); }), HasSubstr("was reset"));
}

// Regression: a device whose context could not be made current again ended the process.
TEST_P(DeviceFailure, LostContext) {
  const Replaced current(epoxy_eglMakeCurrent,
                         PFNEGLMAKECURRENTPROC([](EGLDisplay, EGLSurface, EGLSurface,
                                                  EGLContext) -> EGLBoolean { return EGL_FALSE; }));
  EXPECT_THAT(test::error_of([&] { return map(); }), HasSubstr("cannot be used"));
}

TEST_P(DeviceFailure, OutOfMemory) {
  const Replaced error(epoxy_glGetError, PFNGLGETERRORPROC([]() -> GLenum { return GL_OUT_OF_MEMORY; }));
  EXPECT_THAT(test::error_of([&] { return map(); }), HasSubstr("not enough memory"));
}

TEST_P(DeviceFailure, UnsupportedFramebuffer) {
  const Replaced status(epoxy_glCheckNamedFramebufferStatus,
                        PFNGLCHECKNAMEDFRAMEBUFFERSTATUSPROC(
                            [](GLuint, GLenum) -> GLenum { return GL_FRAMEBUFFER_UNSUPPORTED; }));
  EXPECT_THAT(test::error_of([&] { return map(); }), HasSubstr("cannot draw"));
}

// A device that draws nothing must be an error, not a map without values.
TEST_P(DeviceFailure, MissingTexels) {
  const Replaced draw(epoxy_glDrawElements,
                      PFNGLDRAWELEMENTSPROC([](GLenum, GLsizei, GLenum, const void*) {}));
  EXPECT_THAT(test::error_of([&] { return map(); }), HasSubstr("without a value"));
}

// If a driver lets the wrong site win, the depth drawn differs from that site's distance.
TEST_P(DeviceFailure, WrongDepthsAreReportedAndCorrected) {
  static const PFNGLGETTEXTURESUBIMAGEPROC read = epoxy_glGetTextureSubImage;
  const Replaced wrong(epoxy_glGetTextureSubImage,
                       PFNGLGETTEXTURESUBIMAGEPROC([](GLuint texture, GLint level, GLint x, GLint y, GLint z,
                                                      GLsizei width, GLsizei height, GLsizei depth,
                                                      GLenum format, GLenum type, GLsizei size, void* out) {
                         read(texture, level, x, y, z, width, height, depth, format, type, size, out);
                         if (format == GL_DEPTH_COMPONENT)
                           std::memset(out, 0, static_cast<std::size_t>(size));
                       }));
  const test::GlMap found = test::unconfirmed_gl_map(surface_, sites_, {.clip = GetParam()});
  EXPECT_GT(found.report.unconfirmed, surface_.owned_texels() / 2);
  test::Disagreements distances(1e-6);
  for (const std::uint32_t t : surface_.sample_texels())
    distances.compare(t, found.distance[t], expected_[t]);
  EXPECT_TRUE(distances.none());
}

TEST_P(DeviceFailure, RejectedShader) {
  {  // discard the cached device, so that the next map compiles its shaders
    const Replaced reset(epoxy_glGetGraphicsResetStatus, PFNGLGETGRAPHICSRESETSTATUSPROC([]() -> GLenum {
                           return GL_UNKNOWN_CONTEXT_RESET;
                         }));
    EXPECT_THAT(test::error_of([&] { return map(); }), HasSubstr("was reset"));
  }
  const Replaced status(epoxy_glGetShaderiv,
                        PFNGLGETSHADERIVPROC([](GLuint, GLenum, GLint* value) { *value = GL_FALSE; }));
  EXPECT_THAT(test::error_of([&] { return map(); }),
              testing::AllOf(HasSubstr("site_polygon.vert"), HasSubstr("does not compile")));
}

}  // namespace
}  // namespace sdm
