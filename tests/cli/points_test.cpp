// `sdm points`, and the library behind it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/measure.h>
#include <sdm/points.h>

#include <fmt/format.h>
#include <lzf.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "cli/samples.h"
#include "sites/closest_on_face.h"
#include "support/error_of.h"
#include "support/meshes.h"
#include "support/points.h"
#include "support/run_sdm.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Json = nlohmann::json;

template <class T>
void append(std::string& bytes, T value, bool swapped = false) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (swapped) std::ranges::reverse(raw);
  bytes.append(raw.data(), raw.size());
}

/// A row of points.ply.
struct Row {
  Vec3 point{}, normal{};
  float distance = 0;
  std::int32_t face = -1;
  std::array<std::uint8_t, 3> rgb{};
};

std::vector<Row> read_rows(const std::filesystem::path& file, bool normals) {
  const std::string bytes = contents(file);
  const std::size_t begin = bytes.find("end_header\n") + 11;
  const std::size_t size = 24 + (normals ? 12 : 0) + 8 + 3;
  EXPECT_EQ((bytes.size() - begin) % size, 0u);
  std::vector<Row> rows;
  for (std::size_t at = begin; at + size <= bytes.size(); at += size) {
    Row& row = rows.emplace_back();
    const char* from = bytes.data() + at;
    std::memcpy(row.point.data(), from, 24);
    from += 24;
    for (int k = 0; normals && k < 3; ++k, from += 4) {
      float x;
      std::memcpy(&x, from, 4);
      row.normal[k] = x;
    }
    std::memcpy(&row.distance, from, 4);
    std::memcpy(&row.face, from + 4, 4);
    std::memcpy(row.rgb.data(), from + 8, 3);
  }
  return rows;
}

struct PointsCommand : ::testing::Test {
  TemporaryFolder folder;
  Mesh mesh = joined(cube(1), ring(16, 0.5, {2.5, 0.4, 0.2}));
  std::string o2 = write_obj(folder / "part.obj", mesh);
  std::string out = folder / "out";
  std::vector<Vec3> points = made_points();

  static std::vector<Vec3> made_points() {
    std::mt19937 random(1);
    std::vector<Vec3> result;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 p = random_point({{-2, -2, -2}, {4, 2, 2}}, random);
      result.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
    }
    return result;
  }

  std::string with(const std::string& name, const std::string& contents) const {
    std::ofstream(folder / name, std::ios::binary) << contents;
    return folder / name;
  }
  std::string xyz(const std::vector<Vec3>& from) const {
    std::string text;
    for (const Vec3& p : from) text += fmt::format("{} {} {}\n", p[0], p[1], p[2]);
    return with("cloud.xyz", text);
  }
  Outcome run(const std::string& cloud, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"points", cloud, o2, "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_sdm(arguments);
  }
  /// The signed distance by a search of all faces.
  double oracle(const Vec3& p) const {
    const Sites sites(mesh);
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
      least = std::min(least, sites::closest_on_face(internals(sites), f, p).distance);
    const bool in_cube = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) < 1;
    return in_cube ? -least : least;
  }
};

TEST_F(PointsCommand, DistancesAreThoseOfAllFacesInTheOrderOfTheInput) {
  const Outcome found = run(xyz(points), {"--json"});
  ASSERT_EQ(found.code, 0) << found.err;
  std::vector<std::string> names{"points.ply", "report.json"};
  if (can_write_html()) names.insert(names.begin() + 1, "report.html");
  EXPECT_EQ(names_in(out), names);
  EXPECT_EQ(found.out, contents(out + "/report.json"));
  EXPECT_EQ(Json::parse(found.out)["o1"]["xxh3"], file_xxh3(folder / "cloud.xyz"));
  const std::vector<Row> rows = read_rows(out + "/points.ply", false);
  ASSERT_EQ(rows.size(), points.size());
  const Sites sites(mesh);
  double sum = 0, largest = -1e9;
  std::size_t inside = 0, at = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].point, points[i]);
    // In the ring the sign is the command's; the cube is simple enough for an oracle.
    if (i % 10 == 0 && points[i][0] < 1.5) {
      EXPECT_NEAR(rows[i].distance, oracle(points[i]), 1e-5);
    }
    ASSERT_GE(rows[i].face, 0);
    const ClosestPoint c =
        sites::closest_on_face(internals(sites), static_cast<std::uint32_t>(rows[i].face), points[i]);
    EXPECT_NEAR(c.distance, std::abs(rows[i].distance), 1e-5);
    sum += rows[i].distance;
    inside += rows[i].distance < 0;
    if (rows[i].distance > largest) {
      largest = rows[i].distance;
      at = i;
    }
  }
  const Json report = Json::parse(found.out);
  EXPECT_EQ(report["o1"]["points"], points.size());
  EXPECT_EQ(report["o1"]["normals"], false);
  EXPECT_EQ(report["points_with_value"], points.size());
  EXPECT_EQ(report["negative_points"], inside);
  EXPECT_GT(inside, 10u);
  EXPECT_NEAR(report["distance"]["mean"], sum / 3000, 1e-9);
  EXPECT_EQ(report["distance"]["weights"], "points");
  EXPECT_EQ(report["extremes"]["max"]["index"], at);
  EXPECT_EQ(report["extremes"]["max"]["distance"], largest);
  std::vector<float> sorted;
  for (const Row& row : rows) sorted.push_back(row.distance);
  std::ranges::sort(sorted);
  EXPECT_EQ(report["distance"]["p50"], sorted[1499]);
  EXPECT_EQ(report["distance"]["p95"], sorted[2849]);
  for (float& d : sorted) d = std::abs(d);
  std::ranges::sort(sorted);
  EXPECT_EQ(report["distance"]["p99_abs"], sorted[2969]);
}

// Places were small below four points of one: "below 4e+02 % each".
TEST_F(PointsCommand, APlaceOfAllPointsIsNotSmall) {
  const std::string cloud = folder / "one.xyz";
  std::ofstream(cloud) << "1 2 3\n";
  const Outcome run = run_sdm({"points", cloud, o2, "-o", out, "--tolerance", "0.01"});
  EXPECT_EQ(run.code, 3) << run.err;
  EXPECT_THAT(run.out, HasSubstr("1 out of tolerance, with 1 point, 100 % of them"));
}

TEST_F(PointsCommand, WritesTheFilesThatAreAsked) {
  ASSERT_EQ(run(xyz(points), {"--write", "ply"}).code, 0);
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"points.ply", "report.json"}));
  ASSERT_EQ(run(xyz(points), {"--write", "none"}).code, 0);
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"report.json"}));
  EXPECT_EQ(run(xyz(points), {"--write", "none,ply"}).code, 2);
  EXPECT_EQ(run(xyz(points), {"--write", "exr"}).code, 2);
  if (!can_write_html()) {
    EXPECT_THAT(run(xyz(points), {"--write", "html"}).err, HasSubstr("SDM_BUILD_REPORT"));
    return;
  }
  ASSERT_EQ(run(xyz(points), {"--write", "html"}).code, 0);
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"report.html", "report.json"}));
}

// The walls are looked at once, for the verdict and for the note, which is in all summaries.
TEST_F(PointsCommand, SummariesHaveTheNoteOnWalls) {
  const Sites sites(mesh);
  const PointDistancesOptions options{.picture = {.tolerance = 1.1, .units = "mm"}};
  const PointDistances found =
      measure_points(with("a.xyz", "0 0 2\n0 0 1.5\n"), sites, folder / "found.ply", options);
  EXPECT_DOUBLE_EQ(found.thin_walls, thin_walls(sites));
  const auto note = note_on_walls(sites, Tolerance(1.1), "mm");
  ASSERT_TRUE(note);
  EXPECT_THAT(summarize(found, options).notes, ::testing::ElementsAre(*note));
}

// A distance at a limit may be on either side of it, and signs may be estimates.
TEST_F(PointsCommand, StatesWhatIsNotDecided) {
  const std::string cloud = with("a.xyz", "0 0 2\n0 0 1.5\n");
  const auto verdict = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome found = run(cloud, arguments);
    return std::pair(Json::parse(found.out)["tolerance"]["verdict"].get<std::string>(), found.code);
  };
  EXPECT_EQ(verdict({"--tolerance", "1.1", "--accept-doubts"}), std::pair(std::string("PASS"), 0));
  EXPECT_EQ(verdict({"--tolerance", "1.1"}), std::pair(std::string("DOUBTFUL"), 5)) << "of walls of 2";
  EXPECT_EQ(verdict({"--tolerance", "1"}), std::pair(std::string("NOT DECIDED"), 4));
  EXPECT_EQ(verdict({"--tolerance", "0.9"}), std::pair(std::string("FAIL"), 3));
  EXPECT_THAT(run(with("none.xyz", "nan 0 0\n"), {"--tolerance", "1"}).out,
              HasSubstr("NOT DECIDED: no point is left to measure"));
  o2 = write_obj(folder / "open.obj", square(8, 0));
  EXPECT_EQ(verdict({"--tolerance", "-0.1:2.5", "--sign", "winding"}),
            std::pair(std::string("NOT DECIDED"), 4));
  EXPECT_THAT(run(cloud, {"--tolerance", "-0.1:2.5", "--sign", "winding"}).out,
              HasSubstr("signs are estimates"));
}

// Parts of any size, and all formats, give the same result.
TEST_F(PointsCommand, FormatsAndPartsAgree) {
  std::string ply =
      "ply\nformat ascii 1.0\ncomment x\nelement vertex 3000\nproperty float x\nproperty float y\n"
      "property uchar red\nproperty float z\nend_header\n";
  std::string little =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3000\nproperty double x\nproperty double y\n"
      "property double z\nproperty uchar red\nelement face 0\nproperty list uchar int vertex_indices\n"
      "end_header\n";
  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3000\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  const std::string pcd =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 2\n"
      "WIDTH 3000\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3000\nDATA ";
  std::string ascii = pcd + "ascii\n", binary = pcd + "binary\n";
  std::string csv = "x,y,z,intensity\n";
  for (const Vec3& p : points) {
    ply += fmt::format("{} {} 7 {}\n", p[0], p[1], p[2]);
    csv += fmt::format("{},{},{},0.5\r\n", p[0], p[1], p[2]);
    ascii += fmt::format("{} {} {} 1 2\n", p[0], p[1], p[2]);
    for (const double x : p) {
      append(little, x);
      append(big, static_cast<float>(x), true);
      append(binary, static_cast<float>(x));
    }
    little += '\x07';
    binary += "\x01\x02\x03\x04\x05\x06\x07\x08";
  }
  const Sites sites(mesh);
  const std::filesystem::path expected = folder / "expected.ply", found = folder / "found.ply";
  const PointDistances first = measure_points(xyz(points), sites, expected);
  for (const std::string& file : {with("a.ply", ply), with("b.ply", little), with("c.ply", big),
                                  with("a.pcd", ascii), with("b.pcd", binary), with("a.csv", csv)}) {
    const PointDistances other = measure_points(file, sites, found, {.chunk = 777});
    EXPECT_EQ(contents(found), contents(expected)) << file;
    EXPECT_EQ(other.distance.p95_abs, first.distance.p95_abs);
    EXPECT_EQ(other.distance.mean, first.distance.mean);
  }
}

/// A PCD file whose fields x, y, rgb and z are compressed, as the Point Cloud Library writes it.
std::string compressed_pcd(const std::vector<Vec3>& points) {
  std::string columns;
  for (const int k : {0, 1, -1, 2})
    for (const Vec3& p : points) k < 0 ? append(columns, 7u) : append(columns, static_cast<float>(p[k]));
  std::string block(columns.size() + 100, '\0');
  block.resize(lzf_compress(columns.data(), static_cast<unsigned>(columns.size()), block.data(),
                            static_cast<unsigned>(block.size())));
  EXPECT_FALSE(block.empty());
  const std::string count = std::to_string(points.size());
  std::string file = "VERSION 0.7\nFIELDS x y rgb z\nSIZE 4 4 4 4\nTYPE F F U F\nWIDTH " + count +
                     "\nHEIGHT 1\nPOINTS " + count + "\nDATA binary_compressed\n";
  append(file, static_cast<std::uint32_t>(block.size()));
  append(file, static_cast<std::uint32_t>(columns.size()));
  return file + block;
}

constexpr double kLasScale = 1.0 / 1024, kLasOffset = 3;

/// A LAS file of version 1.`minor` and a point format with one more number; coordinates are rounded.
std::string las(const std::vector<Vec3>& points, int minor, std::uint8_t format = 0) {
  const std::size_t header = minor >= 4 ? 375 : 227, record = 22;
  std::string file(header, '\0');
  const auto put = [&](std::size_t at, auto value) {
    std::string bytes;
    append(bytes, value);
    std::ranges::copy(bytes, file.begin() + static_cast<std::ptrdiff_t>(at));
  };
  std::ranges::copy(std::string_view("LASF"), file.begin());
  put(24, std::uint8_t{1});
  put(25, static_cast<std::uint8_t>(minor));
  put(94, static_cast<std::uint16_t>(header));
  put(96, static_cast<std::uint32_t>(header + 10));
  put(104, format);
  put(105, static_cast<std::uint16_t>(record));
  put(107, static_cast<std::uint32_t>(minor >= 4 ? 0 : points.size()));
  if (minor >= 4) put(247, std::uint64_t{points.size()});
  for (std::size_t k = 0; k < 3; ++k) {
    put(131 + 8 * k, kLasScale);
    put(155 + 8 * k, kLasOffset);
  }
  file.append(10, '\x2a');  // a record of variable length
  for (const Vec3& p : points) {
    for (const double x : p)
      append(file, static_cast<std::int32_t>(std::lround((x - kLasOffset) / kLasScale)));
    file.append(record - 12, '\x55');
  }
  return file;
}

TEST_F(PointsCommand, ReadsCompressedPcdInParts) {
  const Sites sites(mesh);
  const std::filesystem::path expected = folder / "expected.ply", found = folder / "found.ply";
  (void)measure_points(xyz(points), sites, expected);
  (void)measure_points(with("c.pcd", compressed_pcd(points)), sites, found, {.chunk = 777});
  EXPECT_EQ(contents(found), contents(expected));
}

TEST_F(PointsCommand, ReadsLas) {
  for (Vec3& p : points)
    for (double& x : p) x = kLasScale * std::round(x / kLasScale);
  const Sites sites(mesh);
  const std::filesystem::path expected = folder / "expected.ply", found = folder / "found.ply";
  (void)measure_points(xyz(points), sites, expected);
  for (const int minor : {0, 2, 3, 4}) {
    (void)measure_points(with("a.las", las(points, minor)), sites, found, {.chunk = 777});
    EXPECT_EQ(contents(found), contents(expected)) << minor;
  }
}

TEST_F(PointsCommand, NormalsAreKeptAndTurned) {
  const std::string cloud = with("n.xyz", "0 0 3 0 0 1\n3 0 0 1 0 0\n");
  ASSERT_EQ(run(cloud, {"--transform-o1", "rotate:0:90:0,scale:2"}).code, 0);
  const std::vector<Row> rows = read_rows(out + "/points.ply", true);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].point, (Vec3{6, 0, 0}));
  EXPECT_EQ(rows[0].normal, (Vec3{1, 0, 0}));
  EXPECT_EQ(rows[1].normal, (Vec3{0, 0, -1}));
  ASSERT_EQ(run(with("c.xyz", "0 0 3 255 0 1\n3 0 0 1 0 0\n")).code, 0) << "colours";
  EXPECT_EQ(read_rows(out + "/points.ply", false).size(), 2u);
}

// By the inverse transpose: perpendicular to the surface, and on its outside under a reflection.
TEST_F(PointsCommand, NormalsFollowMirroredAndUnevenMatrices) {
  const std::string cloud = with("n.xyz", "3 0 0 1 0 0\n0 3 0 0.6 0.8 0\n");
  const auto normals = [&](const std::string& matrix) {
    const Outcome done = run(cloud, {"--transform-o1", "matrix:" + with("m.txt", matrix)});
    EXPECT_EQ(done.code, 0) << done.err;
    const std::vector<Row> rows = read_rows(out + "/points.ply", true);
    return std::array{rows.at(0).normal, rows.at(1).normal};
  };
  const auto expect = [](const std::array<Vec3, 2>& found, const Vec3& a, const Vec3& b) {
    EXPECT_LT(norm(found[0] - normalized(a)), 1e-6);
    EXPECT_LT(norm(found[1] - normalized(b)), 1e-6);
  };
  expect(normals("-1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1"), {-1, 0, 0}, {-0.6, 0.8, 0});
  expect(normals("2 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1"), {1, 0, 0}, {0.3, 0.8, 0});
  expect(normals("1 1 0 0  0 1 0 0  0 0 1 0  0 0 0 1"), {1, -1, 0}, {0.6, 0.2, 0});
  expect(normals("-2 0 0 0  0 1 0 0  0 0 3 0  0 0 0 1"), {-1, 0, 0}, {-0.3, 0.8, 0});
  EXPECT_THAT(
      run(cloud, {"--transform-o1", "matrix:" + with("m.txt", "1 0 0 0 0 1 0 0 0 0 0 0 0 0 0 1")}).err,
      HasSubstr("singular"));
  Transform flat;
  flat.rows[1][1] = 0;
  EXPECT_THAT(
      error_of([&] { return measure_points(cloud, Sites(mesh), folder / "flat.ply", {.placement = flat}); }),
      HasSubstr("singular"));
}

// Regression: the normals of a mirrored cloud were turned inside out, so that its samples were those of the
// other side.
TEST_F(PointsCommand, AlignsAMirroredCloudByItsNormals) {
  std::mt19937 random(7);
  mesh = joined(cube(1), ring(16, 0.5, {0.9, 0.4, 0.2}));
  o2 = write_obj(folder / "joined.obj", mesh);
  const std::string mirror = "-1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1";
  // Points of a thin shell's outer side, mirrored, with normals that the matrix has to mirror back.
  std::string text;
  for (const Triangle& t : mesh.triangles) {
    const auto& p = mesh.positions;
    const Vec3 n = normalized(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
    for (int i = 0; i < 20; ++i) {
      std::uniform_real_distribution<double> unit(0, 1);
      double u = unit(random), v = unit(random);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Vec3 q = p[t[0]] + u * (p[t[1]] - p[t[0]]) + v * (p[t[2]] - p[t[0]]);
      text += fmt::format("{} {} {} {} {} {}\n", -q[0] + 0.02, q[1] - 0.01, q[2], -n[0], n[1], n[2]);
    }
  }
  const Outcome found = run(with("mirrored.xyz", text),
                            {"--transform-o1", "matrix:" + with("m.txt", mirror), "--align", "--json"});
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_LT(Json::parse(found.out)["distance"]["p95_abs"], 1e-9);
}

// Places without a measurement keep their rows.
TEST_F(PointsCommand, InvalidAndFarPoints) {
  const std::string cloud = with("gaps.xyz", "0 0 3\nnan nan nan\n0 0 1.5\n0 inf 0\n50 0 0\n");
  const Outcome found = run(cloud, {"--json", "--max-distance", "10", "--tolerance", "1"});
  ASSERT_EQ(found.code, 3) << found.err;
  const Json report = Json::parse(found.out);
  EXPECT_EQ(report["o1"]["points"], 5);
  EXPECT_EQ(report["o1"]["invalid_points"], 2);
  EXPECT_EQ(report["beyond_max_distance"], 1);
  EXPECT_EQ(report["points_with_value"], 2);
  EXPECT_EQ(report["tolerance"]["exceeded_points"], 2);
  EXPECT_EQ(report["extremes"]["max"]["index"], 0);
  const std::vector<Row> rows = read_rows(out + "/points.ply", false);
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0].distance, 2);
  EXPECT_EQ(rows[2].distance, 0.5f);
  for (const int i : {1, 3, 4}) {
    EXPECT_TRUE(std::isnan(rows[i].distance));
    EXPECT_EQ(rows[i].face, -1);
    EXPECT_EQ(rows[i].rgb, rows[1].rgb);
  }
  EXPECT_NE(rows[0].rgb, rows[2].rgb);
  EXPECT_EQ(run(cloud, {"--max-distance", "100", "--tolerance", "60", "--accept-doubts"}).code, 0);
  EXPECT_EQ(run(with("none.xyz", "nan 0 0\n"), {}).code, 0);
}

TEST_F(PointsCommand, AlignsTheCloud) {
  std::mt19937 random(4);
  mesh = joined(cube(1), ring(16, 0.5, {0.9, 0.4, 0.2}));
  o2 = write_obj(folder / "joined.obj", mesh);
  std::vector<Vec3> scan = random_surface_points(mesh, 5000, random);
  for (std::size_t i = 0; i < scan.size(); i += 100) scan[i] = random_point(bounds(mesh), random);
  const std::string cloud = xyz(placed(scan, "rotate:1:-2:1,translate:0.04:0.02:-0.03"));
  const Outcome found = run(cloud, {"--align", "--json"});
  ASSERT_EQ(found.code, 0) << found.err;
  const Json report = Json::parse(found.out);
  EXPECT_LT(report["distance"]["p95_abs"], 1e-9);
  EXPECT_EQ(report["alignment"], Json::parse(contents(out + "/alignment.json")));
  const std::string ply = contents(out + "/points.ply"), matrix = folder / "matrix.json";
  std::filesystem::copy_file(out + "/alignment.json", matrix);
  ASSERT_EQ(run(cloud, {"--transform-o1", "matrix:" + matrix}).code, 0);
  EXPECT_EQ(contents(out + "/points.ply"), ply);
  EXPECT_FALSE(std::filesystem::exists(out + "/alignment.json"));
}

// To the box [0, 10]^3, which all of these points are above.
TEST_F(PointsCommand, DistancesOfTextCloudsAreThoseOfTheirPoints) {
  Mesh box = cube(5);
  for (Vec3& p : box.positions)
    for (double& x : p) x += 5;
  o2 = write_obj(folder / "box.obj", box);
  const auto distances = [&](const std::string& contents) {
    const Outcome found = run(with("a.txt", contents), {"--write", "ply"});
    EXPECT_EQ(found.code, 0) << found.err;
    std::vector<float> result;
    for (const Row& row : read_rows(out + "/points.ply", false)) result.push_back(row.distance);
    return result;
  };
  using Distances = std::vector<float>;
  EXPECT_EQ(distances("id,x,y,z\n1,5.0,5.0,12.0\n2,5.0,5.0,13.0\n3,5,5,14\n"), (Distances{2, 3, 4}));
  EXPECT_EQ(distances("1,5;2,5;12,25\n1,5;3,5;12,75\n"), (Distances{2.25, 2.75}));
  EXPECT_EQ(distances("\xEF\xBB\xBF"
                      "5 5 12\n5 5 13\n"),
            (Distances{2, 3}));
  EXPECT_EQ(distances("5 5 12\r5 5 13\r5 5 14\r"), (Distances{2, 3, 4}));
  EXPECT_EQ(distances("2\n1\n100 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n100 0 0 1\n"
                      "-95 5 12 0.5\n-95 5 13 0.5\n"),
            (Distances{2, 3}));
  const Outcome refused = run(with("a.off", "OFF\n8 6 12\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"));
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("a.off: this is a mesh (OFF)"), HasSubstr("sdm map")));
}

// The dialect of a text is decided once, stated, and the same wherever the cloud is read.
TEST_F(PointsCommand, TextIsReadInOneDialectThroughout) {
  std::mt19937 random(4);
  const std::vector<Vec3> scan = random_surface_points(mesh, 3000, random);
  std::string plain, csv = "\xEF\xBB\xBF\"id\";Z;X;Y\r\n";
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const auto& [x, y, z] = scan[i];
    plain += fmt::format("{} {} {}\n", x, y, z);
    std::string row = fmt::format("{};{};{};{}\r\n", i, z, x, y);
    std::ranges::replace(row, '.', ',');
    csv += row;
  }
  ASSERT_EQ(run(with("plain.xyz", plain), {"--align"}).code, 0);
  const auto matrix = [&] { return Json::parse(contents(out + "/alignment.json"))["matrix"].dump(); };
  const std::string ply = contents(out + "/points.ply"), alignment = matrix();
  EXPECT_EQ(Json::parse(contents(out + "/report.json"))["o1"]["text"],
            Json::parse(R"({"separator": "blank", "decimal": "point", "columns": ["x", "y", "z"],
                            "header_line": null})"));
  const std::string file = with("scan.csv", csv);
  const Outcome found = run(file, {"--align"});
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out,
              HasSubstr("text      separator semicolon, decimal comma, columns _,z,x,y, header in line 1\n"));
  EXPECT_EQ(contents(out + "/points.ply"), ply);
  EXPECT_EQ(matrix(), alignment);
  const Json o1 = Json::parse(contents(out + "/report.json"))["o1"];
  EXPECT_EQ(o1["format"], "text");
  EXPECT_EQ(o1["text"], Json::parse(R"({"separator": "semicolon", "decimal": "comma",
                                        "columns": ["_", "z", "x", "y"], "header_line": 1})"));
  // The same by options, where the file does not say it.
  const std::string bare = with("bare.csv", csv.substr(csv.find('\n') + 1));
  EXPECT_THAT(run(bare, {"--align"}).err, HasSubstr("--columns, --separator and --decimal"));
  ASSERT_EQ(
      run(bare, {"--align", "--columns", "_,z,x,y", "--separator", "semicolon", "--decimal", "comma"}).code,
      0);
  EXPECT_EQ(contents(out + "/points.ply"), ply);
  EXPECT_EQ(matrix(), alignment);

  EXPECT_EQ(run(file, {"--columns", "x,y"}).code, 2);
  EXPECT_EQ(run(file, {"--columns", "x,y,z,x"}).code, 2);
  EXPECT_EQ(run(file, {"--separator", "dot"}).code, 2);
  EXPECT_EQ(run(file, {"--decimal", ";"}).code, 2);
  ASSERT_EQ(run(with("a.las", las(points, 2))).code, 0);
  EXPECT_EQ(Json::parse(contents(out + "/report.json"))["o1"]["format"], "LAS");
  EXPECT_EQ(Json::parse(contents(out + "/report.json"))["o1"]["text"], nullptr);
}

TEST_F(PointsCommand, BadFilesAreOneSentence) {
  const auto refused = [&](const std::string& name, const std::string& contents, const char* fault) {
    const std::string file = with(name, contents);
    const Outcome found = run(file);
    EXPECT_EQ(found.code, 1) << contents;
    EXPECT_THAT(found.err, AllOf(HasSubstr(file + ": "), HasSubstr(fault)));
    EXPECT_EQ(std::ranges::count(found.err, '\n'), 1);
    EXPECT_FALSE(std::filesystem::exists(out));
  };
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex 2\n";
  const std::string xyz_fields = "property float x\nproperty float y\nproperty float z\nend_header\n";
  refused("a.xyz", "", "is empty");
  refused("a.xyz", "Dear Sir or Madam", "unknown format");
  refused("a.xyz", "1 2 3\n4 5\n", "line 2: 2 columns where 3 are needed");
  refused("a.xyz", "1 2 3\n4 5 x\n", "line 2: expected a number, not 'x'");
  const std::string good_las = las(points, 2), good_pcd = compressed_pcd(points);
  refused("a.las", good_las.substr(0, 200), "the header of the LAS file is cut off");
  refused("a.las", good_las.substr(0, 5000), "more than the file can hold");
  refused("a.las", las(points, 2, 128 + 1), "LAZ, compressed LAS, is not supported");
  refused("a.e57", "ASTM-E57" + std::string(40, '\0'), "E57 is not supported; convert the cloud to LAS");
  refused("a.las", las(points, 5), "does not exist up to LAS 1.4");
  std::string flat = good_las;
  std::fill_n(flat.begin() + 131, 8, '\0');
  refused("a.las", flat, "is zero or not a number");
  refused("a.pcd", good_pcd.substr(0, good_pcd.size() - 20), "cut off or damaged");
  std::string damaged = good_pcd;
  std::fill(damaged.end() - 300, damaged.end(), '\xff');
  refused("a.pcd", damaged, "cut off or damaged");
  std::string long_pcd = good_pcd;
  long_pcd[long_pcd.find("POINTS 3000") + 10] = '1';
  refused("a.pcd", long_pcd, "cut off or damaged");
  refused("a.ply", ply + "property float x\nend_header\n", "no fields x, y and z");
  refused("a.ply", ply + xyz_fields + "1 2 3\n", "ends after 1 of 2 points");
  refused("a.ply", ply + xyz_fields + "1 2 3\n1 2 3 4\n", "4 columns where 3");
  refused("a.ply", ply + "property list uchar int x\nend_header\n", "have a list");
  refused("a.ply", "ply\nformat ascii 1.0\nelement face 1\nproperty int x\nend_header\n1\n", "no vertices");
  refused("a.ply", "ply\nformat ascii 1.0\nelement camera 1\nproperty int c\nelement vertex 1\n" + xyz_fields,
          "element camera precedes");
  refused("a.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n" + xyz_fields + "abc",
          "more than the file can hold");
  const std::string pcd =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n";
  refused("a.pcd", pcd + "DATA binary_compressed\n", "cut off or damaged");
  refused("a.pcd", pcd + "DATA zip\n", "neither ascii, binary nor binary_compressed");
  refused("a.pcd", pcd + "DATA binary\nabc", "more than the file can hold");
  refused("a.pcd", pcd, "no line DATA");
  refused("a.pcd", "FIELDS x y z\nSIZE 4\nTYPE F\nDATA ascii\n", "different numbers of values");
  refused("a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nDATA ascii\n1 2 3\n", "no number of points");
  refused("a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE I F F\nCOUNT 2 1 1\nPOINTS 1\nDATA ascii\n1 1 2 3\n",
          "no fields x, y and z of one number each");
  refused("a.pcd", "FIELDS x y z\nSIZE 4 4 -4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n",
          "not a whole number");
  refused("a.pcd", "FIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n",
          "type that does not exist");
  EXPECT_THAT(run(folder / "missing.xyz").err, HasSubstr("there is no such file"));
  EXPECT_THAT(run(folder.path()).err, HasSubstr("this is a folder"));
  EXPECT_THAT(run(xyz(points), {"--transform-o1", "fit"}).err, HasSubstr("'fit' needs a mesh"));
  EXPECT_EQ(run(xyz(points), {"--tolerance", "2", "--max-distance", "1"}).code, 2);
}

TEST(PointReader, ReadsInParts) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.xyz") << "# comment\n3\n1 2 3\n\n4 5 6 // last column\n7 8 9";
  PointReader reader(folder / "a.xyz");
  EXPECT_FALSE(reader.count());
  EXPECT_FALSE(reader.has_normals());
  std::vector<Vec3> points, normals;
  ASSERT_TRUE(reader.read(2, points, normals));
  EXPECT_EQ(points, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
  ASSERT_TRUE(reader.read(2, points, normals));
  EXPECT_EQ(points, (std::vector<Vec3>{{7, 8, 9}}));
  EXPECT_FALSE(reader.read(2, points, normals));
}

TEST(PointReader, SamplesAllPartsOfAFile) {
  const TemporaryFolder folder;
  std::ofstream file(folder / "a.xyz");
  for (int i = 0; i < 10000; ++i) file << i << " 0 0\n";
  file << "nan 0 0\n";
  file.close();
  const PointSample sample = sample_points(folder / "a.xyz", 1000);
  ASSERT_EQ(sample.points.size(), 1000u);
  double mean = 0;
  for (const Vec3& p : sample.points) mean += p[0] / 1000;
  EXPECT_NEAR(mean, 5000, 400) << "four standard deviations of the mean";
  EXPECT_EQ(sample_points(folder / "a.xyz", 20000).points.size(), 10000u);
  const auto cancel = [](std::string_view, double) { return false; };
  EXPECT_THROW((void)sample_points(folder / "a.xyz", 1000, {.progress = cancel}), Cancelled);
}

// A text is read for the number of its points first.
TEST(PointReader, CountingIsCancelled) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.xyz") << "1 2 3\n4 5 6\n";
  const Sites sites(cube(1));
  std::vector<std::string> steps;
  PointDistancesOptions options;
  options.map.progress = [&](std::string_view step, double) {
    steps.emplace_back(step);
    return false;
  };
  EXPECT_THROW((void)measure_points(folder / "a.xyz", sites, folder / "a.ply", options), Cancelled);
  EXPECT_EQ(steps, std::vector<std::string>{"count"});
  EXPECT_FALSE(std::filesystem::exists(folder / "a.ply"));
}

}  // namespace
}  // namespace sdm::test
