// Machines without wgpu-native, simulated: this program's dlopen replaces the system's.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/engine.h>

#include <string_view>

#include "support/error_of.h"

namespace {
bool missing = true;
}

extern "C" void* dlopen(const char* file, int mode) noexcept {
  if (missing && file != nullptr && std::string_view(file) == "libwgpu_native.so") return nullptr;
  static const auto next = reinterpret_cast<decltype(&dlopen)>(dlsym(RTLD_NEXT, "dlopen"));
  return next(file, mode);
}

namespace sdm {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(MissingLibrary, ErrorNamesTheLibraryAndTheNextCallFindsIt) {
  EXPECT_THAT(test::error_of([] { return make_engine("gpu"); }),
              AllOf(HasSubstr("libwgpu_native.so"), HasSubstr("another engine")));
  missing = false;
  EXPECT_EQ(test::error_of([] { return make_engine("gpu"); }), "");
}

}  // namespace
}  // namespace sdm
