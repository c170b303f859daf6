// `sdm metrics`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/mesh_files.h>
#include <sdm/metrics.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/samples.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

struct MetricsCommandTest : testing::Test {
  const TemporaryFolder folder;
  const std::string o1 = write_obj(folder / "o1.obj", square(1, 0)),
                    o2 = write_obj(folder / "o2.obj", square(1, 0.25));

  [[nodiscard]] Outcome metrics(std::vector<std::string> more) const {
    more.insert(more.begin(), {"metrics", o1, o2});
    return run_sdm(more);
  }
};

TEST_F(MetricsCommandTest, PrintsWhatTheLibraryComputes) {
  const std::string ball = write_obj(folder / "ball.obj", sphere(2));
  const Outcome run = run_sdm(
      {"metrics", ball, o2, "--json", "--tolerance", "0.5,1", "--percentile", "50,95", "--units", "mm"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  const MetricsOptions options{.percentiles = {50, 95}, .tolerances = {0.5, 1}};
  const SurfaceMetrics expected = surface_metrics(read_mesh(ball), read_mesh(o2), options);
  for (const NamedMetric& m : named_metrics(expected, options)) {
    EXPECT_EQ(json["metrics"][m.name]["value"], m.number.value) << m.name;
    EXPECT_EQ(json["metrics"][m.name]["lower"], m.number.lower) << m.name;
    EXPECT_EQ(json["metrics"][m.name]["upper"], m.number.upper) << m.name;
  }
  EXPECT_EQ(json["metrics"].size(), named_metrics(expected, options).size());
  EXPECT_EQ(json["o2_to_o1"]["mean"]["value"], expected.from[1].mean.value);
  EXPECT_EQ(json["o1_to_o2"]["percentiles"][0]["percent"], 50);
  EXPECT_EQ(json["o1_to_o2"]["within"][1]["upper"], expected.from[0].within[1].upper);
  EXPECT_EQ(json["metrics"]["normal_consistency"]["kind"], "estimate");
  EXPECT_FALSE(json.contains("verdict"));
}

TEST_F(MetricsCommandTest, PrintsEstimatesWithTheirConfidence) {
  const std::string ball = write_obj(folder / "ball.obj", sphere(2));
  const std::vector<std::string> command{"metrics", ball,          o2,      "--estimate", "--tolerance",
                                         "0.5",     "--precision", "0.005", "--quiet"};
  std::vector<std::string> as_json = command;
  as_json.emplace_back("--json");
  const Outcome run = run_sdm(as_json);
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  for (const char* name : {"hd95", "assd", "rmsd", "chamfer_l2", "nsd(0.5)", "f_score(0.5)"}) {
    const Json& number = json["metrics"][name];
    EXPECT_EQ(number["kind"], "estimate") << name;
    EXPECT_EQ(number["confidence"], 0.99) << name;
    EXPECT_LT(number["lower"], number["upper"]) << name;
  }
  EXPECT_EQ(json["metrics"]["hd"]["kind"], "bounded");
  EXPECT_FALSE(json["metrics"]["hd"].contains("confidence"));
  EXPECT_FALSE(json["metrics"]["normal_consistency"].contains("confidence"));
  EXPECT_EQ(json["o1_to_o2"]["mean"]["confidence"], 0.99);
  EXPECT_GE(json["o2_to_o1"]["points"], 65536);
  const SurfaceMetrics expected = surface_metrics(read_mesh(ball), read_mesh(o2), {.precision = 0.005});
  EXPECT_LE(json["metrics"]["hd95"]["lower"], expected.percentiles[0].upper);
  EXPECT_GE(json["metrics"]["hd95"]["upper"], expected.percentiles[0].lower);
  const std::string text = run_sdm({command.begin(), command.end() - 1}).out;
  EXPECT_THAT(text, testing::ContainsRegex("hd95 .* between .*, 99 % \\(estimate\\)"));
  EXPECT_THAT(text, HasSubstr("99 % hold for each number, not for all at once"));
  const Outcome gate = metrics({"--estimate", "--fail-if", "hd95>0.1"});
  EXPECT_EQ(gate.code, 2) << "verdicts are those of bounds";
  EXPECT_THAT(gate.err, HasSubstr("--estimate"));
}

// More than a hundred thousand parts, of which only sums are kept.
TEST_F(MetricsCommandTest, OfManyEqualFacesNeedsLittleMemory) {
  Mesh faces{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {}};
  for (int i = 0; i < 59; ++i) faces.triangles.push_back({0, 1, 2});
  const std::string many = write_obj(folder / "many.obj", faces),
                    ring = write_obj(folder / "ring.obj", torus(32, 16));
  faces.triangles.resize(1);
  const std::string one = write_obj(folder / "one.obj", faces);
  const auto directed = [&](const std::string& mesh) {
    const Outcome run = run_sdm(
        {"metrics", mesh, ring, "--json", "--threads", "1", "--percentile", "50,95", "--tolerance", "0.3"},
        {.memory = std::uint64_t{104} << 20});
    EXPECT_EQ(run.code, 0) << run.err;
    return Json::parse(run.out)["o1_to_o2"];
  };
  const Json of_many = directed(many), of_one = directed(one);
  const auto agree = [](const Json& a, const Json& b, double width) {
    EXPECT_LE(a["upper"].get<double>() - a["lower"].get<double>(), width);
    EXPECT_LE(a["lower"], b["upper"]);
    EXPECT_GE(a["upper"], b["lower"]);
  };
  for (const char* name : {"mean", "rms"})
    agree(of_many[name], of_one[name], 0.0021 * of_one[name]["upper"].get<double>());
  for (int i = 0; i < 2; ++i) {
    const Json& expected = of_one["percentiles"][i];
    agree(of_many["percentiles"][i], expected, 0.0025 * expected["upper"].get<double>());
  }
  agree(of_many["within"][0], of_one["within"][0], 0.0011);
}

TEST_F(MetricsCommandTest, PrintsUnitsAndBounds) {
  const std::string text = metrics({"--units", "mm", "--tolerance", "0.5"}).out;
  EXPECT_THAT(text, HasSubstr("  hd                  0.25 mm ("));
  EXPECT_THAT(text, HasSubstr("  chamfer_l2          0.125 mm² "));
  EXPECT_THAT(text, HasSubstr("  nsd(0.5)            1 (exact)"));
  EXPECT_THAT(text, HasSubstr("normal_consistency  1 (estimate)"));
  EXPECT_EQ(metrics({"--quiet"}).out, "");
}

// At most a unit of the last of six digits farther apart.
TEST_F(MetricsCommandTest, RoundsPrintedBoundsOutwards) {
  const std::string ball = write_obj(folder / "ball.obj", sphere(2)),
                    ring = write_obj(folder / "ring.obj", torus(16, 8));
  const std::vector<std::string> command{"metrics", ball, ring, "--tolerance", "0.1,0.3"};
  std::vector<std::string> as_json = command;
  as_json.emplace_back("--json");
  const Json json = Json::parse(run_sdm(as_json).out)["metrics"];
  std::istringstream lines(run_sdm(command).out);
  int bounded = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, value, between, lower, conjunction, upper;
    if (!(words >> name >> value >> between >> lower >> conjunction >> upper) || between != "between")
      continue;
    const double low = json[name]["lower"], high = json[name]["upper"];
    EXPECT_LE(std::stod(lower), low) << line;
    EXPECT_GE(std::stod(upper), high) << line;
    EXPECT_NEAR(std::stod(lower), low, 1e-5 * low) << line;
    EXPECT_NEAR(std::stod(upper), high, 1e-5 * high) << line;
    ++bounded;
  }
  EXPECT_GE(bounded, 10);
}

TEST_F(MetricsCommandTest, FailsUnderConditions) {
  const auto outcome = [&](const std::vector<std::string>& conditions) {
    std::vector<std::string> more{"--json"};
    for (const std::string& c : conditions) more.insert(more.end(), {"--fail-if", c});
    return metrics(more);
  };
  EXPECT_EQ(outcome({"hd95>0.26"}).code, 0);
  EXPECT_EQ(outcome({"hd95 > 0.24"}).code, 3);
  EXPECT_EQ(outcome({"hd95>0.26", "assd>=0.2"}).code, 3);
  EXPECT_EQ(outcome({"nsd(0.3)<0.95"}).code, 0);
  EXPECT_EQ(outcome({"f_score(0.2)<0.95"}).code, 3);
  EXPECT_EQ(outcome({"normal_consistency<0.5"}).code, 0);
  EXPECT_EQ(run_sdm({"metrics", o1, o1, "--tolerance", "0", "--fail-if", "nsd(-0)<0.5"}).code, 0)
      << "one name for 0 and -0";
  const Json json = Json::parse(outcome({"hd99>0.3", "recall(0.2)<=0.5"}).out);
  EXPECT_EQ(json["verdict"], "FAIL");
  EXPECT_EQ(json["fail_if"][0]["text"], "hd99>0.3");
  EXPECT_EQ(json["fail_if"][0]["verdict"], "PASS");
  EXPECT_EQ(json["fail_if"][1]["verdict"], "FAIL");
  EXPECT_TRUE(json["metrics"].contains("hd99"));
  EXPECT_TRUE(json["metrics"].contains("recall(0.2)"));
}

// The bounds of a curved pair contain the limit at first.
TEST_F(MetricsCommandTest, ComputesCloserBoundsUntilALimitIsDecided) {
  const std::string a = write_obj(folder / "a.obj", sphere(3)),
                    b = write_obj(folder / "b.obj", torus(24, 12));
  const Json json = Json::parse(run_sdm({"metrics", a, b, "--json", "--precision", "0.1"}).out);
  const double lower = json["metrics"]["assd"]["lower"], value = json["metrics"]["assd"]["value"];
  const std::string limit = std::to_string(lower + 0.1 * (value - lower));
  const int code = run_sdm({"metrics", a, b, "--precision", "0.1", "--fail-if", "assd>" + limit}).code;
  EXPECT_TRUE(code == 0 || code == 3) << code;
}

TEST_F(MetricsCommandTest, RefusesWhatIsNoCondition) {
  for (const auto& [condition, reason] :
       std::vector<std::pair<std::string, std::string>>{{"hd95", "has no comparison"},
                                                        {"hd95>", "does not end with a number"},
                                                        {"hd95>x", "does not end with a number"},
                                                        {"hd100>1", "names no measure"},
                                                        {"dice>1", "names no measure"},
                                                        {"nsd>1", "names no measure"},
                                                        {"hd>1 2", "does not end with a number"},
                                                        {"nsd(-1)>1", "names no measure"}}) {
    const Outcome run = metrics({"--fail-if", condition});
    EXPECT_EQ(run.code, 2) << condition;
    EXPECT_THAT(run.err, HasSubstr(reason));
    EXPECT_THAT(run.err, HasSubstr(condition));
  }
  EXPECT_EQ(metrics({"--percentile", "100"}).code, 2);
  EXPECT_EQ(metrics({"--tolerance", "-1"}).code, 2);
  EXPECT_EQ(metrics({"--precision", "0"}).code, 2);
  EXPECT_EQ(run_sdm({"metrics", o1, folder / "none.obj"}).code, 1);
}

}  // namespace
}  // namespace sdm::test
