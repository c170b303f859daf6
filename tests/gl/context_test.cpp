// Contexts: choice of the device, current thread, errors. These tests require a device; without a graphics
// card, Mesa's llvmpipe is one.
#define EGL_NO_X11
#include "gl/device/context.h"

#include <epoxy/egl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>

#include <algorithm>
#include <thread>

#include "gl/replaced.h"
#include "support/error_of.h"

namespace sdm::gl {
namespace {

using test::error_of;
using test::Replaced;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(GlContext, DevicesAreListedHardwareFirst) {
  const std::vector<GlDevice> devices = gl_devices();
  ASSERT_FALSE(devices.empty());
  EXPECT_TRUE(std::ranges::is_sorted(devices, {}, &GlDevice::software));
  for (const GlDevice& device : devices) {
    EXPECT_NE(device.name, "");
    EXPECT_NE(device.driver, "");
    EXPECT_TRUE(device.software || !device.name.starts_with("llvmpipe"));
  }
}

TEST(GlContext, UsesTheRequestedDevice) {
  const std::vector<GlDevice> devices = gl_devices();
  EXPECT_EQ(Context("").device().name, devices[0].name);
  for (std::size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(Context(std::to_string(i)).device().name, devices[i].name);
    EXPECT_EQ(Context(devices[i].name).device().name, devices[i].name);
  }
  std::string part = devices[0].name.substr(1, 4);
  EXPECT_EQ(Context(part).device().name, devices[0].name);
  std::ranges::transform(part, part.begin(), [](unsigned char c) { return std::toupper(c); });
  EXPECT_EQ(Context(part).device().name, devices[0].name);
}

TEST(GlContext, UnknownDeviceErrorListsTheDevices) {
  const std::vector<GlDevice> devices = gl_devices();
  for (const std::string wanted : {"no such device", "1000", "-1", "99999999999999999999999", "0x0"}) {
    const std::string error = error_of([&] { Context{wanted}; });
    EXPECT_THAT(error, HasSubstr("'" + wanted + "'"));
    for (std::size_t i = 0; i < devices.size(); ++i)
      EXPECT_THAT(error, HasSubstr(std::to_string(i) + " is " + devices[i].name));
  }
}

TEST(GlContext, IsOpenGL45CoreWithResetNotification) {
  const Context context("");
  const Context::Current current(context);
  EXPECT_GE(epoxy_gl_version(), 45);
  GLint profile = 0;
  glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
  EXPECT_EQ(profile, GL_CONTEXT_CORE_PROFILE_BIT);
  EXPECT_GE(context.max_image_size(), 16384) << "OpenGL 4.5 promises it";
  EXPECT_GE(context.max_texture_buffer_size(), 65536) << "OpenGL 4.5 promises it";
  if (context.device().name.starts_with("llvmpipe")) {
    GLint strategy = 0;
    glGetIntegerv(GL_RESET_NOTIFICATION_STRATEGY, &strategy);
    EXPECT_EQ(strategy, GL_LOSE_CONTEXT_ON_RESET);
  }
}

TEST(GlContext, MoveKeepsTheDevice) {
  Context first("");
  const std::string name = first.device().name;
  Context second(std::move(first));
  EXPECT_EQ(second.device().name, name);
  const Context::Current current(second);
  second.check("moving");
}

TEST(GlCurrent, NestsAndRestoresThePreviousContext) {
  const Context outer(""), inner("");
  EXPECT_EQ(eglGetCurrentContext(), EGL_NO_CONTEXT);
  {
    const Context::Current current(outer);
    const EGLContext former = eglGetCurrentContext();
    EXPECT_NE(former, EGL_NO_CONTEXT);
    {
      const Context::Current nested(inner);
      EXPECT_NE(eglGetCurrentContext(), former);
      const Context::Current again(inner);
    }
    EXPECT_EQ(eglGetCurrentContext(), former);
    EXPECT_EQ(error_of([&] {
                const Context::Current nested(inner);
                throw Error("on the way");
              }),
              "on the way");
    EXPECT_EQ(eglGetCurrentContext(), former);
  }
  EXPECT_EQ(eglGetCurrentContext(), EGL_NO_CONTEXT);
}

TEST(GlCurrent, RestoresTheBoundApi) {
  for (const EGLenum api : {EGL_OPENGL_ES_API, EGL_OPENGL_API}) {
    ASSERT_TRUE(eglBindAPI(api));
    const Context context("");
    EXPECT_EQ(eglQueryAPI(), api);
    { const Context::Current current(context); }
    EXPECT_EQ(eglQueryAPI(), api);
  }
}

TEST(GlCurrent, ReleasesTheContextForOtherThreads) {
  const Context context("");
  GLuint buffer = 0;
  const auto on_a_thread = [&](auto work) {
    std::thread([&] {
      const Context::Current current(context);
      work();
      context.check("working on a thread");
    }).join();
  };
  on_a_thread([&] { glCreateBuffers(1, &buffer); });
  on_a_thread([&] { EXPECT_TRUE(glIsBuffer(buffer)); });
  const Context::Current current(context);
  EXPECT_TRUE(glIsBuffer(buffer));
}

TEST(GlCurrent, RejectsConcurrentUse) {
  const Context context("");
  const Context::Current current(context);
  std::thread([&] {
    EXPECT_THAT(error_of([&] { const Context::Current second(context); }), HasSubstr("no other thread"));
    EXPECT_EQ(eglGetCurrentContext(), EGL_NO_CONTEXT);
  }).join();
  context.check("being refused");
}

struct GlCheck : ::testing::Test {
  Context context{""};
  Context::Current current{context};
  [[nodiscard]] std::string error() const {
    return error_of([&] { context.check("drawing a test"); });
  }
  void expect_error(const std::string& what) const {
    EXPECT_THAT(error(), AllOf(HasSubstr(what), HasSubstr("while drawing a test"),
                               HasSubstr(context.device().name), HasSubstr("choose")));
  }
};

TEST_F(GlCheck, PassesWithoutErrors) {
  EXPECT_EQ(error(), "");
}

TEST_F(GlCheck, ReportsAnErrorOnce) {
  glEnable(GL_RGBA);
  expect_error("GL_INVALID_ENUM");
  EXPECT_EQ(error(), "");
  glBindBuffer(GL_ARRAY_BUFFER, 12345);
  expect_error("GL_INVALID_OPERATION");
  EXPECT_EQ(error(), "");
}

// A texture of terabytes is no substitute: drivers that allocate on first use accept it.
TEST_F(GlCheck, ReportsOutOfMemory) {
  static int errors_left;
  errors_left = 1;
  const Replaced reports(epoxy_glGetError, PFNGLGETERRORPROC([]() -> GLenum {
                           return errors_left-- > 0 ? GL_OUT_OF_MEMORY : GL_NO_ERROR;
                         }));
  expect_error("not enough memory");
  EXPECT_EQ(error(), "");
}

TEST_F(GlCheck, ReportsAReset) {
  const auto expect_reset = [&](PFNGLGETGRAPHICSRESETSTATUSPROC status, const std::string& what) {
    const Replaced reset(epoxy_glGetGraphicsResetStatus, status);
    expect_error(what);
  };
  expect_reset([]() -> GLenum { return GL_GUILTY_CONTEXT_RESET; }, "because of this program");
  expect_reset([]() -> GLenum { return GL_INNOCENT_CONTEXT_RESET; }, "because of another program");
  expect_reset([]() -> GLenum { return GL_UNKNOWN_CONTEXT_RESET; }, "was reset");
  EXPECT_EQ(error(), "");
}

TEST_F(GlCheck, ReportsALostContextThatRepeatsErrorsForever) {
  const Replaced lost(epoxy_glGetError, PFNGLGETERRORPROC([]() -> GLenum { return GL_CONTEXT_LOST; }));
  expect_error("was reset");
}

}  // namespace
}  // namespace sdm::gl
