#include "support/missing_libraries.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/engine.h>

#include "support/error_of.h"

namespace sdm {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(MissingLibrary, ErrorNamesTheLibraryAndTheNextCallFindsIt) {
  test::missing_libraries = {"libwgpu_native.so"};
  EXPECT_THAT(test::error_of([] { return make_engine("gpu"); }),
              AllOf(HasSubstr("libwgpu_native.so"), HasSubstr("another engine")));
  test::missing_libraries.clear();
  EXPECT_EQ(test::error_of([] { return make_engine("gpu"); }), "");
}

}  // namespace
}  // namespace sdm
