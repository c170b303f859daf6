#include "support/missing_libraries.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/gl.h>

#include "support/error_of.h"

namespace sdm {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct MissingLibrary : ::testing::Test {
  ~MissingLibrary() override { test::missing_libraries.clear(); }
};

TEST_F(MissingLibrary, ErrorNamesTheLibraryAndItsPackage) {
  test::missing_libraries = {"libEGL.so.1"};
  EXPECT_THAT(test::error_of(gl_devices), AllOf(HasSubstr("libEGL.so.1"), HasSubstr("libegl1")));
  test::missing_libraries = {"libGL.so.1", "libOpenGL.so.0"};
  EXPECT_THAT(test::error_of(gl_devices), AllOf(HasSubstr("libOpenGL.so.0"), HasSubstr("libopengl0")));
}

TEST_F(MissingLibrary, OneOfTheOpenGLLibrariesSuffices) {
  test::missing_libraries = {"libOpenGL.so.0"};
  EXPECT_EQ(test::error_of(gl_devices), "");
}

}  // namespace
}  // namespace sdm
