// Errors of the gl engine and their messages.
#include <gmock/gmock.h>
#include <sdm/closest_points.h>

#include "closest/engine.h"
#include "core/platform.h"
#include "gl/support.h"
#include "support/error_of.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using test::error_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

struct GlErrors : testing::Test {
  [[nodiscard]] std::string error(const GlOptions& raster) const {
    return error_of([&] { return test::gl_map(surface, sites, raster); });
  }
  const Surface surface{test::cube(), {.resolution = 32}};
  const Sites sites{test::sphere(1)};
};

TEST_F(GlErrors, StencilValuesOutOfRange) {
  for (const int values : {0, -1, 256, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()})
    EXPECT_THAT(error({.clip = GlClip::stencil, .stencil_values = values}),
                AllOf(HasSubstr(std::to_string(values)), HasSubstr("255")));
  EXPECT_EQ(error({.clip = GlClip::stencil, .stencil_values = 1}), "");
}

TEST_F(GlErrors, UnknownDevices) {
  for (const char* device : {"no such device", "99", "-1", "0x0", "99999999999999999999"})
    EXPECT_THAT(error({.device = device}), HasSubstr(device));
  EXPECT_EQ(error({}), "") << "the next map works";
}

TEST_F(GlErrors, BeforeASurfaceExists) {
  EXPECT_FALSE(gl_device(256).name.empty());
  EXPECT_THAT(error_of([] { return gl_device(256, {.device = "no such device"}); }),
              HasSubstr("no such device"));
  EXPECT_THAT(error_of([] { return gl_device(1u << 20); }),
              AllOf(HasSubstr("1048576"), HasSubstr("resolution")));
  EXPECT_THAT(error_of([] { return gl_device(256, {.stencil_values = 0}); }), HasSubstr("255"));
}

TEST_F(GlErrors, ClosestPointsAreNotSupported) {
  const std::vector<Vec3> query{{0, 0, 0}};
  EXPECT_THAT(error_of([&] { return closest_points(sites, query, {.engine = make_engine("gl")}); }),
              AllOf(HasSubstr("gl"), HasSubstr("maps"), HasSubstr("cpu")));
}

TEST_F(GlErrors, InvalidMaximumDistance) {
  for (const double limit : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW((void)compute_map(surface, sites, {.engine = make_engine("gl"), .max_distance = limit}),
                 Error);
}

TEST_F(GlErrors, MapLargerThanTheTexturesOfTheDevice) {
  // One small triangle, in coordinates of its own, keeps the work small. The table of texels needs 1 GB; the
  // map would need 5 more, so only the engine is called.
  if (available_memory() < std::size_t{4} << 30) GTEST_SKIP() << "needs 4 GB of memory";
  const Mesh mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                  .triangles = {{0, 1, 2}},
                  .corner_uvs = {{{{0, 0}, {1e-3, 0}, {0, 1e-3}}}}};
  const Surface large(mesh, {.kind = AtlasKind::uv, .resolution = 16385});
  const auto drop = [](std::size_t, std::span<const Vec3>, const auto&) {};
  const std::string message = error_of([&] { make_engine("gl")->map(large, sites, {}, drop); });
  if (message.empty()) GTEST_SKIP() << "this device allows it";
  EXPECT_THAT(message, AllOf(HasSubstr("16385"), HasSubstr("16384"), HasSubstr("resolution")));
  EXPECT_EQ(error({}), "") << "the next map works";
}

TEST_F(GlErrors, NoneForListedDevices) {
  const std::vector<GlDevice> devices = gl_devices();
  ASSERT_FALSE(devices.empty());
  EXPECT_TRUE(std::ranges::is_sorted(devices, {}, &GlDevice::software)) << "hardware first";
  const auto used = [&](const std::string& device) {
    return test::gl_map(surface, sites, {.device = device}).report.device.name;
  };
  EXPECT_EQ(used(""), devices[0].name);
  for (std::size_t i = 0; i < devices.size(); ++i) EXPECT_EQ(used(std::to_string(i)), devices[i].name);
  std::string part = devices[0].name.substr(0, 6);
  for (char& c : part) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  EXPECT_EQ(used(part), devices[0].name);
}

}  // namespace
}  // namespace sdm
