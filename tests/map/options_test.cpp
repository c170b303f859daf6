// The options that structs declare: their values, and the sentences that refuse them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "support/shapes.h"

namespace sdm {
namespace {

using testing::HasSubstr;

template <class Struct>
class DeclaredOptions : public testing::Test {};

using Declared = testing::Types<AtlasOptions, PrecisionOptions, MapOptions, ClosestPointOptions, AlongOptions,
                                ExclusionRule, SelfProximityOptions, ThicknessOptions, MatchOptions,
                                HausdorffOptions, MetricsOptions, FieldOptions, ProximityOptions>;
TYPED_TEST_SUITE(DeclaredOptions, Declared);

TYPED_TEST(DeclaredOptions, HaveADefaultThatIsAllowedAndCanBeRead) {
  EXPECT_NO_THROW(check_options(TypeParam{}));
  for_each_option<TypeParam>([](const auto& option) {
    const OptionInfo info = info_of(option);
    if (info.default_value.empty()) return;
    TypeParam options;
    EXPECT_TRUE(read_value(option, info.default_value, options)) << info.name << " " << info.default_value;
    EXPECT_EQ(options.*option.member, TypeParam{}.*option.member) << info.name;
  });
}

TYPED_TEST(DeclaredOptions, AreRefusedBeyondTheEndsOfTheirRange) {
  for_each_option<TypeParam>([](const auto& option) {
    const OptionInfo info = info_of(option);
    const auto expect = [&](double value, bool allowed) {
      TypeParam options;
      EXPECT_EQ(read_value(option, text_of(value), options), allowed) << info.name << " " << value;
      if (!allowed) return;
      EXPECT_NO_THROW(check_options(options)) << info.name << " " << value;
    };
    if (info.type != "number" && info.type != "integer") return;
    const OptionRange& range = info.range;
    const bool whole = info.type == "integer";
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (range.least > OptionRange{}.least) {
      expect(range.least, !range.above);
      expect(whole ? range.least - 1 : std::nextafter(range.least, -kInfinity), false);
      expect(whole ? range.least + 1 : std::nextafter(range.least, kInfinity), true);
    }
    if (range.most < OptionRange{}.most) {
      expect(range.most, !range.below);
      expect(whole ? range.most + 1 : std::nextafter(range.most, kInfinity), false);
    }
    expect(std::numeric_limits<double>::quiet_NaN(), false);
    expect(kInfinity, range.most == kInfinity && !whole);
    expect(0.5, !whole && in_range(0.5, range));
  });
}

TYPED_TEST(DeclaredOptions, HaveSentencesAndNames) {
  for (const OptionInfo& info : options_of<TypeParam>()) {
    EXPECT_TRUE(info.text.ends_with('.')) << info.name;
    EXPECT_EQ(info.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::string::npos) << info.name;
    EXPECT_EQ(refused(info, "x", Spelling::dashed),
              spelled(info.name, Spelling::dashed) + " is x: it must be " + needed(info));
  }
}

TEST(Options, AreSpelledByEachDoor) {
  EXPECT_EQ(spelled("max_distance", Spelling::field), "max_distance");
  EXPECT_EQ(spelled("max_distance", Spelling::dashed), "--max-distance");
  EXPECT_EQ(spelled("max_distance", Spelling::camel_case), "maxDistance");
}

TEST(Options, UnknownNamesAreRefusedWithASimilarOne) {
  const std::vector<std::string> known{"sign", "facing"};
  EXPECT_EQ(unknown_name("option", "fasing", known), "unknown option fasing; did you mean facing?");
  EXPECT_EQ(unknown_name("option", "color", known), "unknown option color");
}

std::string failure(const auto& options) {
  try {
    check_options(options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Options, AreCheckedByTheLibrary) {
  EXPECT_EQ(failure(MapOptions{.max_distance = -1}),
            "max_distance is -1: it must be a number greater than 0");
  EXPECT_EQ(failure(MapOptions{.facing = 181}),
            "facing is 181: it must be a number of degrees greater than 0 and at most 180");
  EXPECT_EQ(failure(MapOptions{.sign = SignMethod::winding, .facing = 90}),
            "facing excludes sign winding: distances have the sign of the side of the faces");
  EXPECT_EQ(failure(MapOptions{.sign = SignMethod::side, .facing = 90}), "");
  EXPECT_EQ(failure(AlongOptions{.direction = Vec3{0, 0, 0}}),
            "along is 0,0,0: it must be normal or a direction of three numbers, not all 0");
  const Sites sites(test::cube());
  EXPECT_THAT(
      [&] { (void)compute_map(Surface(test::cube(), {.resolution = 16}), sites, {.max_distance = 0}); },
      testing::ThrowsMessage<Error>(HasSubstr("max_distance is 0")));
}

TEST(Options, DirectionsAreNumbersOrNormals) {
  std::optional<Vec3> direction{{1, 2, 3}};
  EXPECT_TRUE(read_direction("normal", direction));
  EXPECT_EQ(direction, std::nullopt);
  EXPECT_TRUE(read_direction("0,-1e-300,2.5", direction));
  EXPECT_EQ(direction, (Vec3{0, -1e-300, 2.5}));
  EXPECT_EQ(text_of(direction), "0,-1e-300,2.5");
  for (const char* text : {"", "normals", "1,2", "1,2,3,4", "0,0,0", "nan,0,0", "1,,2", "inf,0,0"})
    EXPECT_FALSE(read_direction(text, direction)) << text;
}

TEST(Options, AMapNamesThoseOfItsMeasure) {
  const Surface surface(test::cube(), {.resolution = 16});
  const DistanceMap map = compute_map(surface, Sites(test::cube()), {.max_distance = 2.5});
  std::string settings;
  for (const auto& [name, value] : map.measured.settings) settings += name + "=" + value + " ";
  EXPECT_EQ(settings, "max_distance=2.5 sign=automatic facing= ");
}

}  // namespace
}  // namespace sdm
