// Machines without the OpenGL libraries, simulated: this program's dlopen replaces the system's.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/gl.h>

#include <set>

#include "support/error_of.h"

namespace {
std::set<std::string, std::less<>> missing;
}

extern "C" void* dlopen(const char* file, int mode) noexcept {
  if (file != nullptr && missing.contains(file)) return nullptr;
  static const auto next = reinterpret_cast<decltype(&dlopen)>(dlsym(RTLD_NEXT, "dlopen"));
  return next(file, mode);
}

namespace sdm {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct MissingLibrary : ::testing::Test {
  ~MissingLibrary() override { missing.clear(); }
};

TEST_F(MissingLibrary, ErrorNamesTheLibraryAndItsPackage) {
  missing = {"libEGL.so.1"};
  EXPECT_THAT(test::error_of(gl_devices), AllOf(HasSubstr("libEGL.so.1"), HasSubstr("libegl1")));
  missing = {"libGL.so.1", "libOpenGL.so.0"};
  EXPECT_THAT(test::error_of(gl_devices), AllOf(HasSubstr("libOpenGL.so.0"), HasSubstr("libopengl0")));
}

TEST_F(MissingLibrary, OneOfTheOpenGLLibrariesSuffices) {
  missing = {"libOpenGL.so.0"};
  EXPECT_EQ(test::error_of(gl_devices), "");
}

}  // namespace
}  // namespace sdm
