#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/map.h>
#include <sdm/points.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "cli/samples.h"
#include "io/page/player/sequence_player.h"
#include "io/page/report/page_channels.h"
#include "report/page_browser.h"
#include "report/page_fixture.h"
#include "support/made_up_maps.h"
#include "support/run_sdm.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;

/// A channel of an EXR file as raw numbers in a file of its own.
void dump(const std::filesystem::path& exr_file, const char* channel, Imf::PixelType type,
          const std::filesystem::path& raw) {
  Imf::InputFile exr(exr_file.c_str());
  const auto box = exr.header().dataWindow();
  const std::size_t n = static_cast<std::size_t>(box.max.x) + 1;
  std::vector<std::uint32_t> bits(n * (static_cast<std::size_t>(box.max.y) + 1));
  Imf::FrameBuffer frame;
  frame.insert(channel, Imf::Slice(type, reinterpret_cast<char*>(bits.data()), 4, 4 * n));
  exr.setFrameBuffer(frame);
  exr.readPixels(0, box.max.y);
  std::ofstream(raw, std::ios::binary)
      .write(reinterpret_cast<const char*>(bits.data()), static_cast<std::streamsize>(4 * bits.size()));
}

TEST_F(Page, ShowsTheValuesOfTheMap) {
  for (const std::string atlas : {"charts", "triangles"}) {
    const Json report = map({"--resolution", "256", "--atlas", atlas, "--units", "mm"});
    dump(out + "/map.exr", "distance.D", Imf::FLOAT, folder / "distance");
    dump(out + "/map.exr", "site.id", Imf::UINT, folder / "site");
    dump(out + "/map.exr", "site.type", Imf::UINT, folder / "type");
    const double bound = 2 * report["error_bound"].get<double>() + 1e-5;
    EXPECT_TRUE(passes("values", page(),
                       {folder / "distance", folder / "site", folder / "type", "256", std::to_string(kHeight),
                        std::to_string(bound)}))
        << atlas;
  }
}

/// Adds channels to the data of a page whose numbers are all 0.
void add_channels_of_zeros(const std::string& file, const nlohmann::ordered_json& channels) {
  std::string text = contents(file);
  const std::string before = R"(<script type="application/json" id="page">)";
  const std::size_t begin = text.find(before) + before.size(), end = text.find("</script>", begin);
  auto page = nlohmann::ordered_json::parse(text.substr(begin, end - begin));
  EXPECT_FALSE(page["map"].contains("channels"));
  page["map"]["channels"] = channels;
  const auto owned = page["arrays"]["distance"]["count"];
  for (const auto& channel : channels)
    for (int k = 0; k < channel["components"]; ++k)
      page["arrays"][fmt::format("texel_{}_{}", channel["name"].get<std::string>(), k)] = {
          {"count", owned}, {"bytes", {0, 0, 0, 0}}};
  std::ofstream(file) << text.replace(begin, end - begin, page.dump());
}

// A row of the table of channels that is on the page needs nothing else there.
TEST_F(Page, ShowsFurtherChannelsAsNumbers) {
  map({"--resolution", "128", "--units", "mm"});
  Channel row = channels()[0];
  row.name = "wall_thickness";
  Channel pair = row;
  pair.name = "pair";
  pair.planes = {"pair.A", "pair.B"};
  pair.type = ChannelType::uint32;
  pair.is_length = false;
  EXPECT_EQ(io::array_name(pair, 1), "texel_pair_1");
  add_channels_of_zeros(page(), {io::described(row), io::described(pair)});
  // All bits 0 are the least of all floats, which is none.
  EXPECT_TRUE(passes("probes", page(), {"probe-wall_thickness", "none", "probe-pair", "0, 0"}));
}

TEST_F(Page, RecoloursAtOnce) {
  map({"--resolution", "256"});
  EXPECT_TRUE(passes("recolours", page()));
}

TEST_F(Page, CalloutsStay) {
  map({"--resolution", "256"});
  EXPECT_TRUE(passes("callouts", page()));
}

// A lower limit alone has no upper one.
TEST_F(Page, StatesTheLimitsOfWallsThatWereGiven) {
  const Outcome run = run_sdm({"thickness", o1, "-o", out, "--write", "html", "--resolution", "64", "--min",
                               "0.001", "--units", "mm"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(passes("says", page(),
                     {"PASS", "Every measured point has at least 0.001 mm; between them, an estimate."}));
}

TEST_F(Page, IsSavedAsItIsShown) {
  map({"--resolution", "128", "--tolerance", "3", "--field", "part=4711", "--field", "order=A-12"});
  EXPECT_TRUE(passes("saves", page(), {folder / "saved.html"}));
  EXPECT_TRUE(passes("says", folder / "saved.html", {"4711", "A-12", "PASS"}));
}

TEST_F(Page, SavesItsNumbers) {
  const Json report = map({"--resolution", "128", "--tolerance", "3", "--field", "part=4711, \"left\"",
                           "--field", "inspector=</script>"});
  EXPECT_EQ(report["fields"]["inspector"], "</script>");
  EXPECT_TRUE(passes("csv", page(), {out + "/report.json"}));
}

TEST_F(Page, SaysHowThePartWasAligned) {
  o2 = write_obj(folder / "moved.obj", moved(ring(24), {0.05, 0, 0}));
  const Json report = map({"--resolution", "64", "--align", "--units", "mm"});
  const auto words = report["alignment"]["text"].get<std::string>();
  EXPECT_THAT(words, HasSubstr("and moved it by 0.05 mm"));
  EXPECT_THAT(words, HasSubstr("residual rms"));
  EXPECT_TRUE(passes("says", page(),
                     {"Alignment: turned the part by", "mm for the samples that fit, and from", "!->",
                      "!turned O1", "!residual rms", "the alignment\tnothing"}));
}

// The exit code is that of the worse one.
TEST_F(Page, StatesTheWorseVerdictOfPartAndGroups) {
  std::string text = contents(o1);
  std::ofstream(o1) << "g ring\n" << text;
  const std::string passes_table = folder / "wide.csv", fails_table = folder / "tight.csv";
  std::ofstream(passes_table) << "group,lower,upper\nring,0,3\n";
  std::ofstream(fails_table) << "group,lower,upper\nring,0,1\n";
  map({"--resolution", "64", "--tolerance-table", passes_table});
  EXPECT_TRUE(
      passes("says", page(), {"PASS", "Every group of the table of tolerances is within its limits."}));
  map({"--resolution", "64", "--tolerance", "3", "--tolerance-table", fails_table});
  EXPECT_TRUE(
      passes("says", page(), {"FAIL", "1 of 1 groups of the table of tolerances fails: ring. Worst: "}));
}

// Half of the square is below the part, and 0.1 around it.
TEST_F(Page, DrawsTheCoverageOfTheReference) {
  Mesh half = square(2, 0.01);
  for (Vec3& p : half.positions) p[0] = 0.5 * p[0] - 0.5;
  o1 = write_obj(folder / "half.obj", half);
  o2 = write_obj(folder / "whole.obj", square(2, 0));
  const Json report = map({"--resolution", "64", "--tolerance", "0.1", "--min-coverage", "0.5", "--up", "z"});
  const std::string share = report["coverage"]["value"].dump();
  EXPECT_TRUE(passes("covers", page(), {share, folder / "coverage.png"}));

  std::ofstream cloud(folder / "cloud.xyz");
  for (int i = 0; i <= 50; ++i)
    for (int j = 0; j <= 100; ++j) cloud << -1 + 0.02 * i << ' ' << -1 + 0.02 * j << " 0\n";
  cloud.close();
  const Outcome points = run_sdm({"points", folder / "cloud.xyz", o2, "-o", out, "--tolerance", "0.1",
                                  "--min-coverage", "0.5", "--up", "z", "--json"});
  ASSERT_EQ(points.code, 0) << points.err;
  EXPECT_TRUE(passes("covers", page(), {Json::parse(points.out)["coverage"]["value"].dump()}));
}

TEST_F(Page, StatesTheVerdictOfEachGroup) {
  std::string text = contents(o1);
  const std::string table = folder / "table.csv";
  const std::size_t faces = text.find("\nf "), middle = text.find("\nf ", faces + (text.size() - faces) / 2);
  text.insert(middle, "\ng rest");
  text.insert(faces, "\ng ring");
  std::ofstream(o1) << text;
  std::ofstream(table) << "group,lower,upper\nring,0,1\n";
  map({"--resolution", "64", "--tolerance-table", table, "--units", "mm"});
  EXPECT_TRUE(passes("highlights", page(), {folder / "saved.html"}));
  EXPECT_TRUE(
      passes("says", page(), {"Verdicts by group", "ring\tFAIL\tgroup\t0 to 1 mm\t", "\t2.40", "\tproven"}));
}

TEST_F(Page, NamesWhatIsMeasured) {
  o2 = write_obj(folder / "ball.obj", sphere(3));
  map({"--resolution", "64", "--units", "mm"});
  EXPECT_TRUE(passes("says", page(), {"Largest (most outside)", "Smallest (most inside)", "distance in mm"}));
  map({"--resolution", "64", "--facing"});
  EXPECT_TRUE(passes("says", page(), {"Largest (most in front)", "Smallest (most behind)"}));
  map({"--resolution", "64", "--along", "normal"});
  EXPECT_TRUE(passes("says", page(), {"Largest (most in front)", "Smallest (most behind)"}));
  const Outcome walls = run_sdm({"thickness", o1, "-o", out, "--resolution", "64", "--units", "mm"});
  ASSERT_EQ(walls.code, 0) << walls.err;
  EXPECT_TRUE(passes("says", page(),
                     {"thickness in mm", "Thickness\tValue\tKind", "No limits were given (--min, --max)"}));
}

TEST_F(Page, EveryControlHasAName) {
  map({"--resolution", "128", "--tolerance", "3"});
  EXPECT_TRUE(passes("names", page()));
}

TEST_F(Page, PrintsToTwoPages) {
  map({"--resolution", "128", "--tolerance", "3"});
  EXPECT_TRUE(passes("prints", page()));
}

// The largest distance is 2.4, at vertices.
TEST_F(Page, StatesTheVerdict) {
  map({"--resolution", "64", "--tolerance", "3"});
  EXPECT_TRUE(passes("says", page(), {"PASS", "Every point of the surface is within 3."}));
  map({"--resolution", "64", "--tolerance", "2"});
  EXPECT_TRUE(passes("says", page(), {"FAIL", ": a distance of 2.4"}));
  const Json proven = map({"--resolution", "64", "--tolerance", "2.41"});
  EXPECT_FALSE(proven["tolerance"]["proof"].is_null()) << "the map does not decide";
  EXPECT_TRUE(passes("says", page(), {"PASS"}));
  const Json open = map({"--resolution", "64", "--tolerance", "2.399999"});
  ASSERT_FALSE(open["tolerance"]["certified"]);
  EXPECT_TRUE(passes("says", page(), {"NOT DECIDED", "No point is out of 2.4 by more than"}));
  o2 = write_obj(folder / "ball.obj", sphere(3));
  map({"--resolution", "64", "--tolerance", "30", "--facing"});
  EXPECT_TRUE(passes("says", page(), {"PASS", "Every point of the surface is within "}));
  map({"--resolution", "64", "--tolerance=-30:20", "--facing"});
  EXPECT_TRUE(passes("says", page(), {"PASS", "Every point of the surface is within -30 to 20."}));
}

/// The report in a page.
Json report_in(const std::string& page) {
  const std::string text = contents(page), begin = R"(<script type="application/json" id="report">)";
  const std::size_t from = text.find(begin) + begin.size();
  return Json::parse(text.substr(from, text.find("</script>", from) - from));
}

TEST_F(Page, StatesOneFractionOutOfTolerance) {
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--tolerance", "2.1"},
                                               {"--tolerance", "1.9", "--max-distance", "2.2"},
                                               {"--sign", "side", "--tolerance=0:2.05"}}) {
    const Json report = map(more);
    const double fraction = report["tolerance"]["exceeded_area_fraction"];
    ASSERT_GT(fraction, 0.05);
    EXPECT_TRUE(passes("percentages", page(), {fmt::format("{}", fraction)}));
    const std::vector<std::string> places{
        report["places"]["limits_from"] == "tolerance" ? "Places out of tolerance" : "Largest distances"};
    EXPECT_TRUE(passes("says", page(), places));
  }
}

TEST_F(Page, OpensOnTheWorstPlace) {
  map({"--tolerance", "2.3"});
  EXPECT_TRUE(passes("opens", page()));
}

TEST_F(Page, OpensOnTheLargestDistanceOfAPartThatPasses) {
  map({"--tolerance", "3"});
  EXPECT_TRUE(passes("opens", page()));
  EXPECT_TRUE(passes("resets", page()));
}

TEST_F(Page, OpensOnTheThinnestPlace) {
  for (const char* least : {"1", "0.001"}) {
    const Outcome run =
        run_sdm({"thickness", o1, "-o", out, "--write", "html", "--resolution", "128", "--min", least});
    ASSERT_TRUE(run.code == 0 || run.code == 3) << run.err;
    EXPECT_TRUE(passes("opens", page(), {"0.2"})) << least;  // thickness jumps at edges of faces
    EXPECT_TRUE(passes("wallLimits", page(), {least, ""})) << least;
  }
}

TEST_F(Page, ListsThePlacesOfTheReport) {
  const Json report = map({"--tolerance", "2.3"});
  const Json& places = report["places"];
  ASSERT_GT(places["large"]["count"], 0);
  EXPECT_TRUE(passes("says", page(),
                     {"Places out of tolerance", "Connected regions out of the tolerance of",
                      fmt::format("{}, together", places["large"]["count"].get<int>())}));
}

TEST_F(Page, JudgesAsTheLibrary) {
  map({"--resolution", "64"});
  std::mt19937 random(5);
  const auto any_of = [&](std::initializer_list<double> values) {
    return values.begin()[random() % values.size()];
  };
  Json cases = Json::array();
  std::array<int, static_cast<int>(VerdictReason::in_doubt)> reasons{};
  for (int i = 0; i < 4000; ++i) {
    Evidence evidence{.lowest = any_of({-2, -1, -0.5, -0.01, -0.001, 0, 0.5, kInfinity}),
                      .highest = any_of({-0.001, 0, 0.01, 0.5, 1, 2}),
                      .complete = random() % 10 != 0,
                      .unmatched = random() % 2 == 0,
                      .estimated_signs = random() % 3 == 0,
                      .samples_only = random() % 5 == 0,
                      .accuracy = any_of({0, 1e-6, 0.001, 0.02, kInfinity}),
                      .guard = any_of({0, 0, 0.01, 0.4}),
                      .error_bound = any_of({0, 0.01, 0.1, 0.5}),
                      .is_signed = random() % 4 != 0,
                      .thin_walls = any_of({0.01, 1, 2, kInfinity, kInfinity})};
    if (evidence.lowest == kInfinity) {
      evidence.lowest.reset();
      evidence.highest.reset();
    }
    evidence.unmatched = !evidence.complete && random() % 2 == 0;
    evidence.samples_only = random() % 4 == 0;
    if (evidence.samples_only) evidence.error_bound = kInfinity;
    if (evidence.lowest > evidence.highest) continue;
    const double lower = any_of({-2.1, -1, -0.5, 0, 0.001, 0.5}),
                 upper = lower + any_of({0, 0.5, 1, 2.2, 4.2});
    const Judgement j = judge(evidence, {lower, upper});
    ++reasons[static_cast<std::size_t>(j.reason)];
    cases.push_back({{"evidence",
                      {{"lowest", evidence.lowest ? Json(*evidence.lowest) : Json()},
                       {"highest", evidence.highest ? Json(*evidence.highest) : Json()},
                       {"complete", evidence.complete},
                       {"estimated_signs", evidence.estimated_signs},
                       {"unmatched", evidence.unmatched},
                       {"samples_only", evidence.samples_only},
                       {"accuracy", evidence.accuracy},
                       {"error_bound", evidence.error_bound},
                       {"signed", evidence.is_signed},
                       {"guard", evidence.guard},
                       {"thin_walls", evidence.thin_walls},
                       {"unmatched", evidence.unmatched},
                       {"samples_only", evidence.samples_only}}},
                     {"lower", lower},
                     {"upper", upper},
                     {"verdict", name_of(j.verdict)},
                     {"reason", name_of(j.reason)},
                     {"nearestIsLower", j.nearest_is_lower}});
  }
  for (const int count : reasons) EXPECT_GT(count, 0);
  std::ofstream(folder / "cases.json") << cases.dump();
  EXPECT_TRUE(passes("judges", page(), {folder / "cases.json"}));
}

TEST_F(Page, ShowsHostileAndUnusualReports) {
  const std::string script = folder / "<!--<script>alert(1)";
  o1 = write_obj(script, ring(8));
  map({"--resolution", "64", "--units", "<b>\u00b5m</b>"});
  EXPECT_TRUE(passes("says", page(), {"<!--<script>alert(1)", "<b>\u00b5m</b>"}));
  // Nothing in range; some of it.
  map({"--resolution", "64", "--max-distance", "0.1"});
  EXPECT_TRUE(passes("says", page(), {"MEASURED", "No point of the part has a distance"}));
  map({"--resolution", "64", "--max-distance", "2", "--tolerance", "2"});
  EXPECT_TRUE(passes("says", page(), {"FAIL", "no value"}));
}

TEST_F(Page, ShowsSelfDistances) {
  const Outcome run =
      run_sdm({"self", o1, "-o", out, "--resolution", "64", "--write", "html", "--geodesic", "0.5"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(passes("says", page(), {"distance to itself", "MEASURED"}));
  EXPECT_TRUE(passes("withoutTolerance", page()));
}

// Keys that the page does not know become tables; a large map is shown by some of its texels.
TEST_F(Page, ShowsWhatItDoesNotKnow) {
  const Field field = [](const Vec3& p) { return 1e30 * p[0]; };
  const Surface surface(ring(24, 1e30, {1e31, 0, 0}), {.resolution = 2048});
  const Json report{
      {"o1",
       {{"file", "part"},
        {"transform", ""},
        {"vertices", 1},
        {"triangles", 1},
        {"closed", true},
        {"degenerate_faces", 0},
        {"duplicate_faces", 0}}},
      {"new_numbers", {{"first", 1.5}, {"second_fraction", 0.25}, {"inner", {{"third", nullptr}}}}},
      {"bands", {{{"lower", nullptr}, {"upper", 1}, {"area_fraction", 0.5}}}},
      {"odd", {1, "two", nullptr, Json::array()}}};
  const std::string file = folder / "report.html";
  write_html(file, surface, map_of(surface, field), at_vertices(surface.mesh(), field), report.dump());
  EXPECT_TRUE(
      passes("says", file, {"New numbers", "1.5", "25 %", "Bands", "below 1", "50 %", "one of each 2 × 2"}));
}

TEST_F(Page, IsAsSmallAsAskedFor) {
  const Field field = [](const Vec3& p) { return p[0]; };
  const Surface surface(ring(48), {.resolution = 512});
  const auto values = at_vertices(surface.mesh(), field);
  const std::string file = folder / "small.html", whole = folder / "whole.html";
  write_html(file, surface, map_of(surface, field), values, "{}", {.largest = 128, .triangles = 500});
  write_html(whole, surface, map_of(surface, field), values, "{}");
  EXPECT_LT(std::filesystem::file_size(file) + 100'000, std::filesystem::file_size(whole));
  EXPECT_TRUE(passes("says", file, {"one of each 4 × 4", "coarser copy"}));
}

TEST_F(Page, IsRefusedForAnotherSurface) {
  const Field field = [](const Vec3&) { return 1; };
  const Surface surface(ring(6), {.resolution = 64}), other(ring(6), {.resolution = 32});
  EXPECT_THROW(
      write_html(folder / "a.html", surface, map_of(other, field), at_vertices(surface.mesh(), field), "{}"),
      Error);
  EXPECT_THROW(write_html(folder / "a.html", surface, map_of(surface, field), {}, "{}"), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.html"));
}

/// Points on the torus above the plane.
struct CloudPage : Page {
  std::string cloud = folder / "cloud.xyz";

  /// Writes a cloud of `count` points, moved apart by up to `noise`.
  void write_cloud(std::size_t count, double noise) const {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> turn(0, 2 * std::numbers::pi), apart(-noise, noise);
    std::string text;
    for (std::size_t i = 0; i < count; ++i) {
      const double u = turn(random), v = turn(random), r = 1 + 0.4 * std::cos(v) + apart(random);
      text += fmt::format("{:.7} {:.7} {:.7}\n", r * std::cos(u), r * std::sin(u), 0.4 * std::sin(v));
    }
    std::ofstream(cloud) << text;
  }
  Json measure(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"points", cloud, o2, "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = run_sdm(arguments);
    EXPECT_TRUE(run.code == 0 || run.code == 3 || run.code == 4) << run.err;
    return Json::parse(contents(out + "/report.json"));
  }
};

TEST_F(CloudPage, ShowsTheValuesOfThePoints) {
  write_cloud(20000, 0.01);
  measure({"--units", "mm", "--up", "z"});
  EXPECT_TRUE(passes("points", page(), {out + "/points.ply"}));
}

TEST_F(CloudPage, RecoloursAtOnceAndCalloutsStay) {
  write_cloud(3000, 0.01);
  measure({"--units", "mm", "--up", "z"});
  EXPECT_TRUE(passes("recolours", page()));
  EXPECT_TRUE(passes("callouts", page()));
}

TEST_F(CloudPage, ShowsTheVerdictAndTheColoursOfTheReport) {
  write_cloud(2000, 0.01);
  for (const char* tolerance : {"3", "2", "0.5:2.4"}) {
    const Json report = measure({"--tolerance", tolerance});
    EXPECT_EQ(report_in(page()), report);
    const Json& colors = report["colors"];
    EXPECT_TRUE(passes("shows", page(),
                       {report["tolerance"]["verdict"], colors["map"], colors["range"][0].dump(),
                        colors["range"][1].dump()}))
        << tolerance;
  }
}

TEST_F(CloudPage, IsUsableByAllAndPrints) {
  write_cloud(3000, 0);
  measure({"--tolerance", "3"});
  EXPECT_TRUE(passes("names", page()));
  EXPECT_TRUE(passes("prints", page()));
  EXPECT_TRUE(passes("says", page(), {"PASS", "Every point of the cloud is within 3."}));
  measure({"--tolerance", "2"});
  EXPECT_TRUE(
      passes("says", page(), {"FAIL", "of the points are out of tolerance", "All points of the cloud"}));
}

// As in the verdict.
TEST_F(CloudPage, PointsWithoutCoordinatesAreNoneWithoutAValue) {
  write_cloud(300, 0);
  std::ofstream(cloud, std::ios::app) << "nan nan nan\n0 0 50\n";
  measure({"--max-distance", "4"});
  const std::string text = contents(page());
  const std::size_t at = text.find("\"area\":{\"lo\":");
  ASSERT_NE(at, std::string::npos);
  const Json area = Json::parse(text.substr(at + 7, text.find('}', at) - at - 6));
  EXPECT_NEAR(area["without_value"], 1.0 / 301, 1e-6) << area;
}

TEST_F(CloudPage, StatesThePointsOfNoGroup) {
  write_cloud(300, 0);
  std::ofstream(cloud, std::ios::app) << "0 0 50\n";
  const std::string table = folder / "table.csv";
  std::ofstream(table) << "group,lower,upper\nplane,-3,3\n";
  const std::string faces = contents(o2);
  std::ofstream(o2) << "o plane\n" << faces;
  measure({"--tolerance-table", table, "--max-distance", "4"});
  EXPECT_TRUE(
      passes("says", page(),
             {"FAIL", "1 point is of no group, as the reference is farther than the maximum distance (4).",
              "Points out of tolerance"}));
}

TEST_F(CloudPage, ShowsSomeOfManyPoints) {
  write_cloud(400000, 0.01);
  {
    std::ofstream more(cloud, std::ios::app);
    more << "nan nan nan\n0 0 30\n";
    for (int i = 0; i < 7; ++i) more << "0 0 0\n";
    more << "3 0 -1.9\n";
  }
  const Json report = measure();
  ASSERT_EQ(report["extremes"]["max"]["index"], 400001);
  ASSERT_EQ(report["extremes"]["min"]["index"], 400009);
  EXPECT_TRUE(passes("sample", page(), {out + "/points.ply", "155834", "400001", "400009"}));
  EXPECT_LT(std::filesystem::file_size(page()), 5e6);
  EXPECT_TRUE(passes("says", page(), {"each of up to 5832 neighbourhoods"}));
}

// No point, and one place.
TEST_F(CloudPage, ShowsUnusualClouds) {
  for (const char* text : {"nan 0 0\n", "1 2 3\n1 2 3\n"}) {
    std::ofstream(cloud) << text;
    measure({"--tolerance", "1"});
    EXPECT_TRUE(passes("says", page())) << text;
  }
  std::ofstream(cloud) << "0 0 50\nnan 0 0\n";
  measure({"--max-distance", "3", "--tolerance", "1"});
  EXPECT_TRUE(
      passes("says", page(),
             {"FAIL", "A point is farther than the maximum distance (", "Points without coordinates"}));
}

TEST_F(CloudPage, BelongsToAFileOfPoints) {
  write_cloud(100, 0);
  const Sites sites(square(8, kHeight));
  const PointDistances found = measure_points(cloud, sites, folder / "a.ply");
  PointDistances other = found;
  ++other.points;
  EXPECT_THROW(write_points_html(folder / "a.html", folder / "a.ply", other, "{}"), Error);
  EXPECT_THROW(write_points_html(folder / "a.html", o1, found, "{}"), Error);
  EXPECT_THROW(write_points_html(folder / "a.html", folder / "missing.ply", found, "{}"), Error);
  EXPECT_THROW(write_points_html(folder / "a.ply", folder / "a.ply", found, "{}"), Error);
  EXPECT_THROW(measure_points(cloud, sites, cloud), Error) << "over itself";
  EXPECT_FALSE(std::filesystem::exists(folder / "a.html"));
}

/// The torus at rest, and a plane that sinks.
struct PlayerPage : Page {
  static constexpr int kFrames = 9;
  std::string sinking = folder / "sinking";

  PlayerPage() {
    std::filesystem::create_directory(sinking);
    for (int i = 0; i < kFrames; ++i)
      write_obj(std::filesystem::path(sinking) / fmt::format("{}.obj", i), square(8, kHeight - 0.25 * i));
  }
  [[nodiscard]] Outcome play(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"sequence", o1, sinking, "-o", out, "--resolution", "64", "--player"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }
};

TEST_F(PlayerPage, PlaysTheFrames) {
  const Outcome run = play({"--both", "--up", "z"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr(" player.html"));
  EXPECT_TRUE(passes("plays", out + "/player.html", {"-2", "0.25", "8"}));
  const std::string text = contents(out + "/player.html");
  const std::size_t at = text.find("\"scale\":") + 8;
  const Json scale = Json::parse(text.substr(at, text.find('}', at) + 1 - at));
  EXPECT_TRUE(passes("legend", out + "/player.html", {scale["lo"].dump(), scale["hi"].dump()}));
}

TEST_F(PlayerPage, AnimationsPlayInThreeJs) {
  const Outcome run =
      run_sdm({"sequence", o1, sinking, "-o", out, "--resolution", "64", "--animation", "--both"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr(" animation.glb"));
  EXPECT_TRUE(passes("animates", out + "/animation.glb", {"-2", "0.25", "8", out + "/animation.html"}));
}

TEST_F(PlayerPage, ShowsHostileNames) {
  std::filesystem::rename(sinking, folder / "<!--<script>alert(1)");
  sinking = folder / "<!--<script>alert(1)";
  ASSERT_EQ(play({"--units", "<b>mm</b>"}).code, 0);
  EXPECT_TRUE(passes("says", out + "/player.html", {"<!--<script>alert(1)", "<b>mm</b>", "9 frames"}));
}

TEST(SequencePlayer, ThinsOutLongSequences) {
  const TemporaryFolder folder;
  const Sites o1(sphere(5)), o2(square(4, -2));  // 10,242 vertices and more of the square
  SequencePlayer player(o1.mesh(), o2.mesh(), false);
  std::vector<double> values;
  constexpr std::size_t kFrames = 300;
  for (std::size_t i = 0; i < kFrames; ++i) {
    player.add(i, o1, o2);
    values.push_back(static_cast<double>(i));
  }
  EXPECT_EQ(player.frames(), kFrames);
  const std::vector<PlotPanel> panels{{"numbers", {{"", values}}}};
  player.write(folder / "player.html", panels);
  EXPECT_TRUE(
      passes("says", folder / "player.html", {"300 frames, of which 150, one of 2, are in this page"}));
  values.pop_back();
  const std::vector<PlotPanel> wrong{{"numbers", {{"", values}}}};
  EXPECT_THROW(player.write(folder / "no.html", wrong), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "no.html"));
  EXPECT_THROW(player.add(kFrames, o2, o2), Error);
}

TEST(PageSources, HaveCorrectTypes) {
  EXPECT_EQ(
      std::system("cd '" SDM_REPORT_PACKAGES "' && node node_modules/typescript/bin/tsc -p tsconfig.json"),
      0);
}

}  // namespace
}  // namespace sdm::test
