// The options that structs declare: their values, and the sentences that refuse them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/bake.h>
#include <sdm/io.h>
#include <sdm/mesh_files.h>
#include <sdm/points.h>
#include <sdm/proximity_query.h>
#include <sdm/sdm.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "support/shapes.h"

namespace sdm {
namespace {

using testing::HasSubstr;

template <class Struct>
class DeclaredOptions : public testing::Test {};

using Declared =
    testing::Types<AlignFreedoms, AlignOptions, AlongOptions, AmbientOcclusionOptions, AtlasOptions,
                   BakeRequest, ClosestPointOptions, ColorChoice, ExclusionRule, FieldOptions, GlOptions,
                   HausdorffOptions, LevelsOptions, MapOptions, MatchOptions, MetricsOptions, PictureOptions,
                   PoseQueryOptions, PrecisionOptions, ProximityOptions, SelfProximityOptions,
                   SequenceOptions, SummaryOptions, TessellationOptions, TextDialect, ThicknessOptions,
                   TimeOfContactOptions, TransferOptions, WeldOptions>;
TYPED_TEST_SUITE(DeclaredOptions, Declared);

TYPED_TEST(DeclaredOptions, HaveADefaultThatIsAllowedAndCanBeRead) {
  EXPECT_NO_THROW(check_options(TypeParam{}));
  for_each_option<TypeParam>([](const auto& option) {
    const OptionInfo info = info_of(option);
    if (info.default_value.empty()) return;
    TypeParam options;
    EXPECT_TRUE(read_value(option, info.default_value, options)) << info.name << " " << info.default_value;
    EXPECT_TRUE(options.*option.member == TypeParam{}.*option.member) << info.name;
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
    if (range.least > OptionRange{}.least) {
      expect(range.least, !range.above);
      expect(whole ? range.least - 1 : std::nextafter(range.least, -kInfinity), false);
      expect(whole ? range.least + (range.square ? 3 : 1) : std::nextafter(range.least, kInfinity), true);
    }
    if (range.most < OptionRange{}.most) {
      expect(range.most, !range.below);
      expect(whole ? range.most + 1 : std::nextafter(range.most, kInfinity), false);
    }
    if (range.square) expect(2, false);
    expect(std::numeric_limits<double>::quiet_NaN(), false);
    expect(kInfinity, range.most == kInfinity && !whole);
    expect(0.5, !whole && in_range(0.5, range));
  });
}

// A value just out of the range of an option, that its type has; nothing if there is none.
template <class Value>
std::optional<Value> beyond(const OptionRange& range) {
  constexpr double kMost = std::numeric_limits<double>::max();
  if constexpr (std::is_same_v<Value, bool>) {
    return std::nullopt;
  } else if constexpr (std::is_integral_v<Value>) {
    if (range.least > 0) return static_cast<Value>(range.least - 1);
    return range.most < kMost ? std::optional(static_cast<Value>(range.most + 1)) : std::nullopt;
  } else if constexpr (std::is_same_v<Value, double>) {
    return std::numeric_limits<double>::quiet_NaN();
  } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
    return Value{std::numeric_limits<double>::quiet_NaN()};
  } else if constexpr (std::is_same_v<Value, std::array<double, 2>>) {
    return Value{2, 1};
  } else if constexpr (std::is_same_v<Value, Vec3>) {
    return Value{0, std::numeric_limits<double>::infinity(), 0};
  } else if constexpr (std::is_same_v<Value, Tolerance>) {
    return Value{2, 1};
  } else {
    return std::nullopt;
  }
}

std::string failure(const auto& options) {
  try {
    check_options(options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TYPED_TEST(DeclaredOptions, AreRefusedByTheLibraryAsByTheCommand) {
  for_each_option<TypeParam>([]<class Value>(const Option<TypeParam, Value>& option) {
    const auto value = beyond<typename detail::OptionalOf<Value>::Type>(option.range);
    if (!value) return;
    TypeParam options;
    options.*option.member = *value;
    const OptionInfo info = info_of(option);
    const std::string text = OptionForm<Value>::text(options.*option.member), sentence = failure(options);
    EXPECT_EQ(sentence, refused(info, text, Spelling::field));
    EXPECT_EQ(spelled(info.name, Spelling::dashed) + sentence.substr(info.name.size()),
              refused(info, text, Spelling::dashed));
    TypeParam read;
    EXPECT_FALSE(read_value(option, text, read)) << info.name << " " << text;
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

TEST(Options, OfSeveralNumbersAreReadAsTexts) {
  ColorChoice colors;
  EXPECT_TRUE(read_value(option_of(&ColorChoice::tolerance), "-0.1:0.25", colors));
  EXPECT_EQ(colors.tolerance, Tolerance(-0.1, 0.25));
  EXPECT_TRUE(read_value(option_of(&ColorChoice::tolerance), "0.5", colors));
  EXPECT_EQ(colors.tolerance, Tolerance(0.5));
  for (const char* text : {"", "-1", "2:1", "1:", ":1", "0:inf", "nan", "1:2:3"})
    EXPECT_FALSE(read_value(option_of(&ColorChoice::tolerance), text, colors)) << text;
  EXPECT_TRUE(read_value(option_of(&ColorChoice::range), "-1,2", colors));
  EXPECT_EQ(colors.range, (std::array<double, 2>{-1, 2}));
  for (const char* text : {"1,1", "2,1", "1", "1,2,3", "0,inf"})
    EXPECT_FALSE(read_value(option_of(&ColorChoice::range), text, colors)) << text;
  AlignOptions align;
  EXPECT_TRUE(read_value(option_of(&AlignOptions::freedoms), "xy,rz", align));
  EXPECT_EQ(names_of(align.freedoms), (std::vector<std::string>{"x", "y", "rz"}));
  EXPECT_FALSE(read_value(option_of(&AlignOptions::freedoms), "xy,r", align));
  BakeRequest bake;
  EXPECT_TRUE(read_value(option_of(&BakeRequest::channels), "position,base_color", bake));
  EXPECT_EQ(OptionForm<BakeSelection>::text(*bake.channels), "base_color,position");
  EXPECT_FALSE(read_value(option_of(&BakeRequest::channels), "position,gloss", bake));
  EXPECT_EQ(failure(BakeRequest{.samples = 8}),
            "samples is 8: it must be a whole number from 1 to 64 that is a square");
}

TEST(Options, AMapNamesThoseOfItsMeasure) {
  const Surface surface(test::cube(), {.resolution = 16});
  const DistanceMap map = compute_map(surface, Sites(test::cube()), {.max_distance = 2.5});
  std::string settings;
  for (const auto& [name, value, type] : map.measured.settings) settings += name + "=" + value + " ";
  EXPECT_EQ(settings, "max_distance=2.5 sign=automatic facing= ");
}

}  // namespace
}  // namespace sdm
