// Results by name: what sdm/names.h declares of them is what JSON has, in all outputs.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "io/json/report_json.h"

namespace sdm {
namespace {

/// The names of the declared fields are the keys, in their order.
template <class Struct>
std::vector<std::string> keys_of(const Struct& of) {
  std::vector<std::string> keys;
  const nlohmann::ordered_json json = fields_json(of);
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  return keys;
}

template <class Enum>
void expect_words() {
  for (std::size_t i = 0; i < kWords<Enum>.size(); ++i) {
    EXPECT_EQ(value_of<Enum>(kWords<Enum>[i]), static_cast<Enum>(i));
    EXPECT_STREQ(name_of(static_cast<Enum>(i)), kWords<Enum>[i]);
  }
  EXPECT_FALSE(value_of<Enum>("no such word"));
}

TEST(Fields, AreTheKeysOfJson) {
  const BoundedLength length{{.value = 1, .certainty = Certainty::exact, .lower = 0.5, .upper = 2}};
  EXPECT_EQ(fields_json(length).dump(),
            R"({"value":1.0,"kind":"exact","lower":0.5,"upper":2.0,"witness":null})");
  const DegreeOfFreedom freedom{.axis_point = Vec3{1, 2, 3}, .determined = 0.5, .free = true};
  EXPECT_EQ(fields_json(freedom).dump(),
            R"({"translation":[0.0,0.0,0.0],"rotation":[0.0,0.0,0.0],"axis_point":[1.0,2.0,3.0],)"
            R"("determined":0.5,"standard_error":null,"free":true,"locked":false})");
  EXPECT_EQ(to_json(IslandReport{.islands = 1, .faces = 2}).dump(),
            R"({"islands":1,"triangles":2,"area":0.0,"area_fraction":0.0})");
  EXPECT_EQ(keys_of(Evidence{})[6], "signed");
  EXPECT_EQ(fields_json(Evidence{})["thin_walls"].dump(), "null") << "infinity, once it is printed";
  const TextDialect text{.separator = TextSeparator::tab, .columns = {"x", "y", "z"}};
  EXPECT_EQ(fields_json(text).dump(),
            R"({"separator":"tab","decimal":"automatic","columns":["x","y","z"],"header_line":null})");
}

TEST(Fields, HoldResultsAndIndices) {
  const Place place{.distance = 2, .limits = {-1, 1.5}, .point = {1, 2, 3}, .samples = 4, .kind = "group"};
  EXPECT_EQ(fields_json(place, {{"samples", "texels"}, {"area", ""}, {"fraction", ""}}).dump(),
            R"({"distance":2.0,"point":[1.0,2.0,3.0],"sample":null,"face":null,"texels":4,"kind":"group",)"
            R"("group":"","small":false,"lower":-1.0,"upper":1.5})")
      << "an index that is none is null; limits are two keys";
  Places places;
  places.large = {.count = 1, .samples = 2, .area = 3, .fraction = 0.5};
  places.largest = {place};
  const nlohmann::ordered_json json = fields_json(places, {{"samples", "texels"}});
  EXPECT_EQ(json["large"].dump(), R"({"count":1,"texels":2,"area":3.0,"fraction":0.5})")
      << "keys are those of results in results, too";
  EXPECT_EQ(json["largest"][0]["texels"], 4);
  const ToleranceProof proof{.witness = ToleranceWitness{.distance = 3}, .undecided_by = 0.5};
  EXPECT_EQ(value_json(std::optional(proof))["witness"]["distance"], 3);
  EXPECT_TRUE(value_json(std::optional<ToleranceProof>()).is_null());
  const Alignment alignment;
  EXPECT_EQ(to_json(alignment)["degrees_of_freedom"].size(), 6u);
  EXPECT_EQ(to_json(alignment)["matrix"].size(), 4u);
  EXPECT_EQ(to_json(alignment)["rotation_degrees"], 0);
}

TEST(Fields, AreAddedBehindOthers) {
  nlohmann::ordered_json json{{"a", 1}, {"b", 2}};
  insert_after(json, "a", "new", "x");
  EXPECT_EQ(json.dump(), R"({"a":1,"new":"x","b":2})");
}

TEST(Fields, EnumeratorsAreWords) {
  expect_words<Verdict>();
  expect_words<VerdictReason>();
  expect_words<DoubtReason>();
  expect_words<Certainty>();
  static_assert(kWords<DoubtReason>.size() == static_cast<std::size_t>(DoubtReason::thin_walls) + 1);
  static_assert(kWords<VerdictReason>.size() == static_cast<std::size_t>(VerdictReason::small_places) + 1);
}

TEST(Fields, DoubtsAreReadAgain) {
  std::vector<Doubt> doubts;
  for (std::size_t i = 0; i < kWords<DoubtReason>.size(); ++i)
    doubts.push_back({static_cast<DoubtReason>(i), "text " + std::to_string(i), "remedy"});
  const std::vector<Doubt> again = doubts_from(to_json(doubts));
  ASSERT_EQ(again.size(), doubts.size());
  for (std::size_t i = 0; i < doubts.size(); ++i) {
    EXPECT_EQ(again[i].reason, doubts[i].reason);
    EXPECT_EQ(again[i].text, doubts[i].text);
  }
}

TEST(Fields, TextIsThatOfTheObject) {
  Summary summary;
  summary.units = "mm";
  summary.distance.max = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(summary_json(summary), to_json(summary).dump());
  EXPECT_TRUE(nlohmann::json::parse(summary_json(summary))["distance"]["max"].is_null());
}

}  // namespace
}  // namespace sdm
