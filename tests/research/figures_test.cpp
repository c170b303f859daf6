// `sdm-paper figures` as a user runs it: keys, finite numbers, and the relations between them that must hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <functional>
#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "research/run_sdm_paper.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using OrderedJson = nlohmann::ordered_json;

constexpr double kAccuracy = 2e-6;  // of the engines, relative to the diagonal

/// Calls visit(path, value) for each value that is not an object or an array.
void for_each_value(const OrderedJson& json, const std::string& path,
                    const std::function<void(const std::string&, const OrderedJson&)>& visit) {
  if (json.is_object())
    for (const auto& [key, value] : json.items()) for_each_value(value, path + "/" + key, visit);
  else if (json.is_array())
    for (std::size_t i = 0; i < json.size(); ++i)
      for_each_value(json[i], path + "/" + std::to_string(i), visit);
  else
    visit(path, json);
}

OrderedJson without_times(const OrderedJson& json) {
  if (json.is_array()) {
    OrderedJson result = OrderedJson::array();
    for (const OrderedJson& value : json) result.push_back(without_times(value));
    return result;
  }
  if (!json.is_object()) return json;
  OrderedJson result = OrderedJson::object();
  for (const auto& [key, value] : json.items())
    if (!key.ends_with("_ms")) result[key] = without_times(value);
  return result;
}

/// A quick run of some figures. Fails if a key is missing, a number is not finite, or the page is not what it
/// should be.
struct PaperReport : ::testing::Test {
  TemporaryFolder folder;
  OrderedJson report;

  void run(const std::vector<std::string>& keys) {
    const std::string out = folder / "out";
    std::string only;
    for (const std::string& key : keys) only += (only.empty() ? "" : ",") + key;
    const Outcome outcome = run_sdm_paper({"figures", "-o", out, "--quick", "--only", only});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    ASSERT_THAT(names_in(out), ElementsAre("report.html", "report.json"));
    report = OrderedJson::parse(contents(out + "/report.json"));
    check_json(keys);
    check_page(contents(out + "/report.html"), keys);
  }
  void check_json(const std::vector<std::string>& keys) const {
    for (const char* key : {"version", "quick", "machine"}) EXPECT_TRUE(report.contains(key)) << key;
    for (const char* key : {"processor", "cores", "system", "compiler", "opengl"})
      EXPECT_TRUE(report["machine"].contains(key)) << key;
    for (const std::string& key : keys) {
      ASSERT_TRUE(report.contains(key)) << key;
      EXPECT_TRUE(report[key].contains("paper")) << key;
      EXPECT_TRUE(report[key].contains("measured")) << key;
    }
    // NaN and infinite numbers are null in JSON; null are only the results of the gl engine without a device,
    // and errors at a cost that no row of a method has.
    const bool gl = !report["machine"]["opengl"].is_null();
    for_each_value(report, "", [&](const std::string& path, const OrderedJson& value) {
      EXPECT_TRUE(!gl || !value.is_null() || path.find("/equal_") != std::string::npos) << path;
    });
  }
  void check_page(const std::string& page, const std::vector<std::string>& keys) const {
    for (const std::string& key : keys) EXPECT_THAT(page, HasSubstr("<section id=\"" + key + "\">"));
    for (const char* outside : {"http:", "https:", "<script", "<link"})
      EXPECT_EQ(page.find(outside), std::string::npos) << outside;
    for (const char* no_number : {">nan", " nan", ">inf", " inf "})
      EXPECT_EQ(page.find(no_number), std::string::npos) << no_number;
    EXPECT_THAT(page, HasSubstr(report["machine"]["processor"].get<std::string>()));
    const OrderedJson& opengl = report["machine"]["opengl"];
    if (opengl.is_null() || !opengl["software"].get<bool>()) return;
    EXPECT_THAT(page, HasSubstr("not a GPU"));
  }

  [[nodiscard]] const OrderedJson& measured(const std::string& key) const {
    return report.at(key).at("measured");
  }
};

TEST_F(PaperReport, MapsAreExactAtTheirSamples) {
  ASSERT_NO_FATAL_FAILURE(run({"figure1", "figure3", "figure7", "polygon_count"}));
  for (const std::string key : {"figure1", "figure3", "figure7", "polygon_count"}) {
    EXPECT_LE(measured(key)["error_at_samples"], kAccuracy) << key;
    const OrderedJson gl = measured(key).value("gl_error_at_samples", OrderedJson());
    EXPECT_LE(gl.is_null() ? 0 : gl.get<double>(), kAccuracy) << key;
  }
}

TEST_F(PaperReport, Lemma1HoldsForVectorsOnly) {
  ASSERT_NO_FATAL_FAILURE(run({"figure2", "figure4"}));
  EXPECT_LE(measured("figure2")["vector_error"], 1e-12);
  EXPECT_GT(measured("figure2")["scalar_error"], 1e-5);
  EXPECT_LE(measured("figure2")["texel_residual"], 1e-9);
  EXPECT_LE(measured("figure4")["largest_deviation_of_a_sample"], 1e-12);
  for (int i = 0; i < 2; ++i)
    EXPECT_GE(measured("figure4")["bound"][i], measured("figure4")["measured_gap"][i]);
}

TEST_F(PaperReport, BoundsOnTheSpacingOfSamplesHoldAndThePapersDoesNot) {
  ASSERT_NO_FATAL_FAILURE(run({"figure5", "figure6"}));
  const OrderedJson& m = measured("figure5");
  EXPECT_EQ(m["bounds_hold"], true);
  for (const char* kind : {"scale", "shear"})
    for (std::size_t i = 0; i < m[kind]["measured"].size(); ++i) {
      EXPECT_GE(m[kind]["bound"][i], m[kind]["measured"][i]) << kind << i;
      // The lattice without a border has the radius that is found inside; points at the border have more.
      EXPECT_GE(m[kind]["bound"][i].get<double>(), m[kind]["lattice_radius"][i].get<double>() - 1e-5)
          << kind << i;
    }
  const double violated = m["first_violation_of_paper_bound"];
  EXPECT_GT(violated, 0);
  EXPECT_LT(violated, report["figure5"]["paper"]["shear_threshold"]);
  // The corrected threshold is the same shear in every unit, the printed one is not.
  const OrderedJson& conditions = m["conditions"];
  for (const char* unit : {"cm", "mm"}) {
    EXPECT_DOUBLE_EQ(conditions[unit]["corrected_shear"], conditions["m"]["corrected_shear"]);
    EXPECT_NE(conditions[unit]["printed_shear"], conditions["m"]["printed_shear"]);
  }
  EXPECT_LE(m["stretch"]["largest_share_of_bound"].get<double>(), 1 + 1e-12);
  EXPECT_EQ(measured("figure6")["bounds_hold"], true);
  EXPECT_GT(measured("figure6")["E"]["measured"].size(), 3u);
}

TEST_F(PaperReport, MapsAndVolumesKeepTheirErrorBounds) {
  ASSERT_NO_FATAL_FAILURE(run({"figure8", "table_complexity"}));
  EXPECT_EQ(measured("table_complexity")["bounds_hold"], true);
  for (const auto& [key, method] : measured("table_complexity").items()) {
    if (!method.is_object() || !method.contains("exponents")) continue;
    const double expected = key.starts_with("map") ? 2 : 3;
    EXPECT_NEAR(method["exponents"]["bytes"], expected, 0.01) << key;
    EXPECT_NEAR(method["exponents"]["error_bound"], -1, 0.25) << key;
  }
  for (const char* key : {"map_cpu", "best", "linear_factorization", "difi", "csc"}) {
    EXPECT_GT(measured("figure8")[key]["frame_ms"]["median"], 0) << key;
    EXPECT_GT(measured("figure8")[key]["bytes"], 0) << key;
  }
  // Fields by different methods hold the same distances.
  for (const char* key : {"linear_factorization", "difi"})
    EXPECT_NEAR(measured("figure8")[key]["error_linear"], measured("figure8")["best"]["error_linear"],
                2 * kAccuracy)
        << key;
}

TEST_F(PaperReport, CullingChangesNoMapAndCountsAddUp) {
  ASSERT_NO_FATAL_FAILURE(run({"culling", "stencil"}));
  if (measured("culling").is_null()) GTEST_SKIP() << "no OpenGL device";
  EXPECT_EQ(measured("culling")["maps_identical"], true);
  for (const auto& [key, entry] : measured("culling").items()) {
    if (!entry.is_object()) continue;
    for (const char* bounds : {"with_bounds", "without_bounds"}) {
      const OrderedJson& c = entry[bounds];
      EXPECT_EQ(c["pairs"].get<std::uint64_t>(),
                c["culled_by_bound"].get<std::uint64_t>() + c["culled_by_obb"].get<std::uint64_t>() +
                    c["clipped_away"].get<std::uint64_t>() + c["polygons"].get<std::uint64_t>())
          << key;
    }
    EXPECT_LE(entry["with_bounds"]["polygons"], entry["without_bounds"]["polygons"]) << key;
  }
  for (const char* body : {"letter", "box"})
    for (const char* pairs : {"all_pairs", "winning_pairs"}) {
      const OrderedJson& m = measured("stencil")[body];
      const OrderedJson& hits = m[pairs]["hit_percent"];
      for (std::size_t i = 1; i < hits.size(); ++i) EXPECT_GE(hits[i], hits[i - 1]) << body << pairs;
      EXPECT_LE(hits.back().get<double>(), m[std::string("most_hits_of_") + pairs].get<double>() + 1e-9)
          << body << pairs;
    }
}

TEST_F(PaperReport, TheCorrectedAlgorithmIsExactAndThePrintedOneIsNot) {
  ASSERT_NO_FATAL_FAILURE(run({"literal_algorithm"}));
  if (measured("literal_algorithm")["cases"].is_null()) GTEST_SKIP() << "no OpenGL device";
  for (const auto& [key, variants] : measured("literal_algorithm")["cases"].items()) {
    EXPECT_EQ(variants[0]["variant"], "all corrections");
    EXPECT_EQ(variants[0]["wrong_percent"], 0) << key;
    EXPECT_EQ(variants[1]["variant"], "as printed");
    EXPECT_GT(variants[1]["wrong_percent"], 0) << key;
  }
}

TEST(PaperCommand, IsDeterministicApartFromTimes) {
  const TemporaryFolder folder;
  std::array<OrderedJson, 2> reports;
  for (int i = 0; i < 2; ++i) {
    const std::string out = folder / std::to_string(i);
    const Outcome run = run_sdm_paper({"figures", "-o", out, "--quick", "--only", "figure2,figure4,figure5"});
    ASSERT_EQ(run.code, 0) << run.err;
    reports[i] = without_times(OrderedJson::parse(contents(out + "/report.json")));
  }
  EXPECT_EQ(reports[0], reports[1]);
}

TEST(PaperCommand, RunsWithoutAnOpenGLDevice) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const Outcome run = run_sdm_paper({"figures", "-o", out, "--quick", "--only", "figure1,culling"},
                                    {.environment = {"__EGL_VENDOR_LIBRARY_DIRS=/nowhere"}});
  ASSERT_EQ(run.code, 0) << run.err;
  const OrderedJson report = OrderedJson::parse(contents(out + "/report.json"));
  EXPECT_TRUE(report["machine"]["opengl"].is_null());
  EXPECT_TRUE(report["culling"]["measured"].is_null());
  EXPECT_TRUE(report["figure1"]["measured"]["gl_maps_ms"].is_null());
  EXPECT_LE(report["figure1"]["measured"]["error_at_samples"], kAccuracy);
  EXPECT_THAT(contents(out + "/report.html"), HasSubstr("no OpenGL 4.5 device"));
}

TEST(PaperCommand, WrongUsageAndMissingMeshesLeaveNoTrace) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"figures"},
                                                    {"figures", "-o", out, "--only", "figure9"},
                                                    {"figures", "-o", out, "--threads", "-1"}}) {
    const Outcome run = run_sdm_paper(arguments);
    EXPECT_EQ(run.code, 2) << arguments.back();
    EXPECT_NE(run.err, "");
  }
  // All figures are in one of the tests above.
  EXPECT_THAT(
      run_sdm_paper({"figures", "-o", out, "--only", "figure9"}).err,
      HasSubstr(
          "{figure1,figure2,figure3,figure4,figure5,figure6,figure7,figure8,polygon_count,table_complexity,"
          "stencil,culling,literal_algorithm}"));
  const Outcome missing =
      run_sdm_paper({"figures", "-o", out, "--quick", "--only", "figure7", "--mesh", folder / "none.obj"});
  EXPECT_EQ(missing.code, 1);
  EXPECT_THAT(missing.err, HasSubstr("none.obj"));
  EXPECT_TRUE(folder.empty());
  const Outcome interrupted =
      run_sdm_paper({"figures", "-o", out, "--only", "figure3"}, {.interrupt_after_ms = 1000});
  EXPECT_EQ(interrupted.code, 128 + SIGINT);
  EXPECT_TRUE(folder.empty());
}

}  // namespace
}  // namespace sdm::test
