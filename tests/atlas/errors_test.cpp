#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/sdm.h>
#include <sdm/surface.h>

#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

void expect_error(const Mesh& mesh, const AtlasOptions& options, const char* words) {
  EXPECT_THAT([&] { Surface(mesh, options); }, ThrowsMessage<Error>(HasSubstr(words)));
}

TEST(AtlasErrors, OptionsOutOfRange) {
  const Mesh mesh = test::load("cube.off");
  expect_error(mesh, {.resolution = 15}, "resolution is 15: it must be a whole number from 16 to 32768");
  expect_error(mesh, {.resolution = 32769}, "resolution is 32769");
  expect_error(mesh, {.max_stretch = 1}, "stretch");
  expect_error(mesh, {.max_stretch = std::numeric_limits<double>::quiet_NaN()}, "stretch");
  expect_error(mesh, {.resolution = 64, .gutter = 17}, "gutter of 17");
  expect_error(mesh, {.resolution = 64, .gutter = 0xFFFFFFFF}, "gutter");
  expect_error({}, {}, "no triangles");
}

// The resolution suggested by the message is sufficient.
TEST(AtlasErrors, TooSmallResolutionSuggestsASufficientOne) {
  const Mesh mesh = test::degenerate_soup(1000, 1);
  EXPECT_THAT([&] { Surface(mesh, {.resolution = 64}); },
              ThrowsMessage<Error>(
                  AllOf(HasSubstr("64"), HasSubstr("too small for 1080 charts"), HasSubstr("about 128"))));
  EXPECT_NO_THROW(Surface(mesh, {.resolution = 128}));
}

// Regression: a strip across the whole atlas, which fills little of it, was reported as too large.
TEST(AtlasLayout, LongThinMeshesGetEnoughTexels) {
  for (const double width : {0.1, 0.01, 1e-3, 1e-5})
    for (const std::uint32_t resolution : {64u, 1024u, 4096u}) {
      SCOPED_TRACE(width);
      const Mesh strip{.positions = {{0, 0, 0}, {1, 0, 0}, {1, width, 0}, {0, width, 0}},
                       .triangles = {{0, 1, 2}, {0, 2, 3}},
                       .corner_uvs = {}};
      const Surface surface(strip, {.resolution = resolution});
      EXPECT_GE(surface.sample_texels().size(), resolution / 2);
    }
}

}  // namespace
}  // namespace sdm
