// Point clouds in text: what is in the file is what is read, or an error says why not.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/points.h>
#include <sdm/sites.h>

#include <cmath>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "io_read/writers.h"
#include "support/error_of.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using Points = std::vector<Vec3>;

struct Cloud {
  Points points, normals;
  std::string format;
  std::optional<TextDialect> dialect;
};

Cloud read(const std::string& contents, const TextDialect& given = {}) {
  constexpr std::size_t kMost = 7;  // in several parts
  PointReader reader(write_file("cloud.txt", contents), given);
  Cloud cloud{.points = {}, .normals = {}, .format = reader.format(), .dialect = reader.dialect()};
  Points points, normals;
  while (reader.read(kMost, points, normals)) {
    cloud.points.insert(cloud.points.end(), points.begin(), points.end());
    cloud.normals.insert(cloud.normals.end(), normals.begin(), normals.end());
  }
  return cloud;
}

Points points_of(const std::string& contents, const TextDialect& given = {}) {
  return read(contents, given).points;
}

/// The message without the path.
std::string fault(const std::string& contents, const TextDialect& given = {}) {
  const std::string message = error_of([&] { return read(contents, given); });
  const std::size_t colon = message.find("cloud.txt: ");
  return colon == std::string::npos ? message : message.substr(colon + 11);
}

std::string columns_of(const std::string& contents, const TextDialect& given = {}) {
  return fmt::format("{}", fmt::join(read(contents, given).dialect.value().columns, ","));
}

constexpr const char* kTextOptions = "--columns, --separator and --decimal";

TEST(TextCloud, DecimalCommasAreNotSeparators) {
  const Points expected{{1.5, 2.5, 12.25}, {1.5, 3.5, 12.75}};
  EXPECT_EQ(points_of("1,5;2,5;12,25\n1,5;3,5;12,75\n"), expected);
  EXPECT_EQ(points_of("1,5 2,5 12,25\n1,5 3,5 12,75\n"), expected);
  EXPECT_EQ(points_of("1,5\t2,5\t12,25\n1,5\t3,5\t12,75\n"), expected);
  EXPECT_EQ(points_of("\"1,5\",\"2,5\",\"12,25\"\n\"1,5\",\"3,5\",\"12,75\"\n"), expected);
  EXPECT_EQ(points_of("1.5,2.5,12.25\n1.5,3.5,12.75\n"), expected);
  EXPECT_EQ(points_of("1.5, 2.5, 12.25\n1.5 ,3.5 ,12.75\n"), expected);
  EXPECT_EQ(points_of("+1.5 25e-1 12.25\n1.5 3.5 1275E-2\n"), expected);
  const Cloud cloud = read("x;y;z\n1,5;2,5;12,25\n");
  EXPECT_EQ(cloud.format, "text");
  EXPECT_EQ(cloud.dialect->separator, TextSeparator::semicolon);
  EXPECT_EQ(cloud.dialect->decimal, DecimalMark::comma);
  EXPECT_EQ(cloud.dialect->header_line, 1u);
  // Decided once: a mark that comes later, or another, is a fault.
  EXPECT_THAT(fault("1.5;2;3\n1,5;2;3\n"), StartsWith("line 2: expected a number, not '1,5'"));
  EXPECT_THAT(fault("1,5;2;3\n1.5;2;3\n"), StartsWith("line 2: expected a number, not '1.5'"));
  EXPECT_THAT(fault("1.234,5;2;3\n"), AllOf(HasSubstr("'1.234,5'"), HasSubstr(kTextOptions)));
}

TEST(TextCloud, NamesDecideWhatColumnsAre) {
  const Points expected{{5, 6, 12}, {5, 6, 13}};
  EXPECT_EQ(points_of("id,x,y,z\n1,5.0,6.0,12.0\n2,5,6,13\n"), expected);
  EXPECT_EQ(points_of("Z;Y;X\n12;6;5\n13;6;5\n"), expected);
  EXPECT_EQ(points_of("//X Y Z\n5 6 12\n5 6 13\n"), expected) << "CloudCompare";
  EXPECT_EQ(points_of("//Z Y X R G B\n12 6 5 1 2 3\n13 6 5 1 2 3\n"), expected);
  EXPECT_EQ(points_of("# scan\n# y x z\n6 5 12\n6 5 13\n"), expected);
  EXPECT_EQ(points_of("\"I\",\"X\",\"Y\",\"Z\"\n7,5,6,12\n7,5,6,13\n"), expected);
  EXPECT_EQ(points_of("X (m), Y [m], Z [m]\n5,6,12\n5,6,13\n"), expected);
  EXPECT_EQ(points_of("z, y, x\n12 6 5\n13 6 5\n"), expected) << "other separators than the rows";
  EXPECT_EQ(points_of("Northing\tEasting\tHeight\n6\t5\t12\n6\t5\t13\n"), expected);
  EXPECT_EQ(points_of("\"d\",\"Points:0\",\"Points:1\",\"Points:2\"\n1,5,6,12\n1,5,6,13\n"), expected);
  EXPECT_EQ(points_of("name\tx\ty\tz\nP 1\t5\t6\t12\n\t5\t6\t13\n"), expected) << "text, and an empty cell";
  EXPECT_EQ(points_of("name,x,y,z\n\"a, \"\"b\"\"\",5,6,12\nc#d,5,6,13\n"), expected);
  EXPECT_EQ(points_of("vertex,x,y,z,distance\n0,5,6,12,\n1,5,6,13,0.25\n"), expected) << "vertices.csv";
  EXPECT_EQ(points_of("1,x,y,z,532\n9,5,6,12,0\n9,5,6,13,0\n"), expected) << "names that are numbers";
  EXPECT_EQ(columns_of("id,Z,y,x\n1,2,3,4\n"), "_,z,y,x");

  const Cloud normals = read("normal_x NY normal_z z y x\n0 0 1 12 6 5\n0 1 0 13 6 5\n");
  EXPECT_EQ(normals.points, expected);
  EXPECT_EQ(normals.normals, (Points{{0, 0, 1}, {0, 1, 0}}));

  EXPECT_THAT(fault("a,b,c\n1,2,3\n"),
              AllOf(StartsWith("line 1: "), HasSubstr("x, y and z"), HasSubstr(kTextOptions)));
  EXPECT_THAT(fault("x,y,height\n1,2,3\n"), HasSubstr(kTextOptions));
  EXPECT_THAT(fault("x,y,z,X\n1,2,3,4\n"), HasSubstr("line 1: the column x is there twice"));
  EXPECT_THAT(fault("x,y,z\n1,5,2,5,12,25\n"),
              AllOf(HasSubstr("names 3 columns where rows have 6"), HasSubstr(kTextOptions)));
  EXPECT_THAT(fault("# id x y z\n1 2 3 4 5\n"), AllOf(StartsWith("line 1: "), HasSubstr(kTextOptions)));
  EXPECT_THAT(fault("x,y,z\n"), HasSubstr("line 1: names columns, but no row follows"));
  EXPECT_EQ(points_of("# x y z are metres\n1 2 3\n"), (Points{{1, 2, 3}}));
}

TEST(TextCloud, OnlyAHeaderAndACountAreSkipped) {
  const Points expected{{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(points_of("2\n1 2 3\n4 5 6\n"), expected);
  EXPECT_EQ(points_of("2\nx y z\n1 2 3\n4 5 6\n"), expected);
  EXPECT_EQ(points_of("x y z\n2\n1 2 3\n4 5 6\n"), expected);
  EXPECT_EQ(points_of("# a\n\n// b\n  # c\n1 2 3 # d, 7\n\n4 5 6 // e\n# f"), expected);
  EXPECT_THAT(fault("x y z\nx y z\n1 2 3\n"), StartsWith("line 2: expected a number, not 'x'"));
  EXPECT_THAT(fault("Scan of 5\n1 2 3\n"), AllOf(StartsWith("line 1: "), HasSubstr(kTextOptions)));
  EXPECT_THAT(fault("My scan\n1 2 3\n"), AllOf(StartsWith("line 1: "), HasSubstr(kTextOptions)));
  EXPECT_THAT(fault("ncols 4\nnrows 2\ncellsize 1\n1 2 3 4\n1 2 3 4\n"), StartsWith("unknown format"));
  EXPECT_EQ(fault("Dear Sir or Madam"), "unknown format; " + point_format_names() + " are supported");
  EXPECT_EQ(fault("3\n1 2 3\n4 5 6\n"), "ends after 2 of 3 points; it is truncated");
  EXPECT_THAT(fault("1\n1 2 3\n4 5 6\n"), StartsWith("line 3: more rows follow than the number before them"));
}

TEST(TextCloud, RowsThatDoNotFitAreErrorsWithTheirLine) {
  EXPECT_EQ(fault("1 2 3\n4 5\n"), "line 2: 2 columns where 3 are needed");
  EXPECT_EQ(fault("1 2 3\n4 5 6 7\n"), "line 2: 4 columns where 3 are needed");
  EXPECT_EQ(fault("1 2 3\n\n4 5 x\n"), "line 3: expected a number, not 'x'");
  EXPECT_EQ(fault("x,y,z\n1,2,3\n1,,3\n"), "line 3: a number is missing");
  EXPECT_EQ(fault("1 2 3\n4 5 1e999\n"), "line 2: expected a number, not '1e999'");
  EXPECT_EQ(fault("1 2 3\n4 5 \xC3\xA9\n"), "line 2: expected a number, not '\?\?'");
  EXPECT_EQ(points_of("1,2,3,\n4,5,6,\n"), (Points{{1, 2, 3}, {4, 5, 6}})) << "a separator after the last";
  EXPECT_THAT(fault("1 2 3\n4 5 6 " + std::string(70000, '7') + "\n"),
              StartsWith("line 2: is longer than 65536"));
  EXPECT_THAT(fault(std::string(70000, '7')), StartsWith("line 1: is longer than 65536"));
  EXPECT_THAT(fault(std::string(700000, '7')), StartsWith("line 1: is longer than 65536"));
  // After the lines that decide the dialect, and at any place of the reader's buffer.
  for (const char* end : {"\n", "\r\n", "\r"}) {
    std::string rows;
    for (int i = 0; i < 40000; ++i) rows += fmt::format("{} {}.25 -3{}", i, i % 77, end);
    EXPECT_EQ(points_of(rows).size(), 40000u);
    EXPECT_EQ(fault(rows + "1 2" + end + rows), "line 40001: 2 columns where 3 are needed");
  }
}

// The points after the row would pass for the next ones.
TEST(TextCloud, AReaderThatHasFailedReadsNoFurther) {
  std::string rows;
  for (int i = 0; i < 2000; ++i) rows += "1 2 3\n";
  PointReader reader(write_file("cloud.txt", rows + "4 5\n" + rows));
  Points points, normals;
  constexpr std::size_t kMost = 1500;
  ASSERT_TRUE(reader.read(kMost, points, normals));
  EXPECT_THAT(error_of([&] { (void)reader.read(kMost, points, normals); }), HasSubstr("line 2001"));
  EXPECT_THAT(error_of([&] { (void)reader.read(kMost, points, normals); }), HasSubstr("failed half-way"));
}

TEST(TextCloud, LineEndsAndByteOrderMarks) {
  const Points expected{{5, 5, 12}, {5, 5, 13}, {5, 6, 14}};
  for (const char* mark : {"", "\xEF\xBB\xBF"})
    for (const char* end : {"\n", "\r\n", "\r"})
      for (const char* last : {end, ""})
        EXPECT_EQ(points_of(fmt::format("{0}5 5 12{1}5 5 13{1}5 6 14{2}", mark, end, last)), expected);
  EXPECT_THAT(fault("1 2 3\n4 5 6\r7 8 9\n"), StartsWith("line 2: ")) << "another line end";
  const std::string ply =
      "\xEF\xBB\xBFply\rformat ascii 1.0\relement vertex 1\rproperty float X\rproperty float Y\r"
      "property float Z\rend_header\r1 2 3\r";
  EXPECT_EQ(points_of(ply), (Points{{1, 2, 3}}));
  const std::string pcd =
      "VERSION .7\rFIELDS x y z\rSIZE 4 4 4\rTYPE F F F\rWIDTH 1\rHEIGHT 1\rDATA ascii\r1 2 3";
  EXPECT_EQ(points_of(pcd), (Points{{1, 2, 3}}));
}

TEST(TextCloud, Utf16IsNamed) {
  const std::string text = "1 2 3\n4 5 6\n";
  for (const bool big : {false, true})
    for (const bool mark : {false, true}) {
      std::string wide = mark ? (big ? "\xFE\xFF" : "\xFF\xFE") : "";
      for (const char c : text) wide += big ? std::string{'\0', c} : std::string{c, '\0'};
      EXPECT_EQ(fault(wide), "this is UTF-16 text; save it as UTF-8");
    }
}

TEST(TextCloud, CompressedFilesAreNamed) {
  EXPECT_EQ(fault("\x1F\x8B\x08" + std::string(100, 'x')), "is compressed with gzip; decompress it first");
}

// The fault had neither the file nor the number of the point in it.
TEST(TextCloud, APointThatIsTooFarAwayIsNamed) {
  const TemporaryFolder folder;
  const std::string cloud = folder / "cloud.txt";
  std::ofstream(cloud) << "0 0 0\n1 2 3\n0 -1e38 0\n";
  const std::string expected =
      cloud + ": point 2 has a coordinate beyond 1e37, too large for the computation; scale the cloud down";
  EXPECT_EQ(error_of([&] { (void)sample_points(cloud, 100); }), expected);
  EXPECT_EQ(error_of([&] { (void)measure_points(cloud, Sites(cube()), folder / "points.ply"); }), expected);
  EXPECT_EQ(points_of("0 0 0\n1e37 2 3\n"), (Points{{0, 0, 0}, {1e37, 2, 3}}));
}

TEST(TextCloud, MeshesAreRefusedByTheirFormat) {
  const Mesh mesh = cube(1);
  EXPECT_EQ(fault(off(mesh)), "this is a mesh (OFF), not a point cloud; sdm map measures meshes");
  for (const std::string& contents : {obj(mesh), stl_text(mesh), stl_binary(mesh), glb(mesh), tds(mesh)})
    EXPECT_THAT(fault(contents), AllOf(StartsWith("this is a mesh ("), HasSubstr("sdm map")));
  EXPECT_THAT(fault("COFF\n1 0 0\n0 0 0 255 255 255 255\n"), StartsWith("this is a mesh (OFF)"));
  EXPECT_THAT(fault(std::string("1 2 3\n4 5 6\0\n", 13)), StartsWith("unknown format, not text"));
  // Given columns make a text of it.
  EXPECT_EQ(points_of("v 1 2 3\nv 4 5 6\n", {.columns = {"_", "x", "y", "z"}}),
            (Points{{1, 2, 3}, {4, 5, 6}}));
}

// What the file leaves open is an error that names the options, and these decide.
TEST(TextCloud, OptionsDecideWhatIsAmbiguous) {
  const std::string counted = "1,5.0,5.0,12.0\n2,5.0,5.0,13.0\n3,5,5,14\n";
  EXPECT_THAT(fault(counted), AllOf(HasSubstr("the first column counts the rows"), HasSubstr(kTextOptions)));
  EXPECT_EQ(points_of(counted, {.columns = {"id", "X", "y", "z"}}),
            (Points{{5, 5, 12}, {5, 5, 13}, {5, 5, 14}}));
  EXPECT_EQ(points_of(counted, {.columns = {"x", "y", "z"}}), (Points{{1, 5, 5}, {2, 5, 5}, {3, 5, 5}}));

  const std::string grid = "0 4 1.5 2.5 0.5\n0 7 1.5 2.25 0.5\n1 2 1.25 2.5 0.75\n";
  EXPECT_THAT(fault(grid), AllOf(HasSubstr("the row and column of a scanner"), HasSubstr(kTextOptions)));
  EXPECT_EQ(points_of(grid, {.columns = {"row", "column", "x", "y", "z"}}),
            (Points{{1.5, 2.5, 0.5}, {1.5, 2.25, 0.5}, {1.25, 2.5, 0.75}}));
  EXPECT_EQ(points_of(grid, {.columns = {"x", "y", "z"}}), (Points{{0, 4, 1.5}, {0, 7, 1.5}, {1, 2, 1.25}}));
  // Not in the order of a grid; colours after a height.
  EXPECT_EQ(points_of("0 4 1.5 2.5 0.5\n0 2 1.5 2.25 0.5\n1 2 1.25 2.5 0.75\n").size(), 3u);
  EXPECT_EQ(points_of("0 4 1.5 200 90\n0 5 1.5 210 90\n1 2 1.25 180 91\n").size(), 3u);

  const std::string halves = "1,5,2,5,12,25\n1,5,3,5,12,75\n";
  EXPECT_THAT(fault(halves), AllOf(HasSubstr("decimal commas"), HasSubstr(kTextOptions)));
  EXPECT_EQ(points_of(halves, {.decimal = DecimalMark::point}), (Points{{1, 5, 2}, {1, 5, 3}}));
  EXPECT_EQ(points_of(halves, {.separator = TextSeparator::comma}), (Points{{1, 5, 2}, {1, 5, 3}}));

  EXPECT_THAT(fault("P1 1 2 3\nP2 1 2 4\n"), AllOf(StartsWith("line 1: "), HasSubstr(kTextOptions)));
  EXPECT_EQ(points_of("P1 1 2 3\nP2 1 2 4\n", {.columns = {"name", "x", "y", "z"}}),
            (Points{{1, 2, 3}, {1, 2, 4}}));
  EXPECT_THAT(fault("1,2,3 4,5,6\n"), HasSubstr(kTextOptions));

  const TextDialect swapped{.columns = {"y", "x", "z"}};
  EXPECT_EQ(points_of("x y z w\n1 2 3 4\n", swapped), (Points{{2, 1, 3}})) << "before the names in the file";
  EXPECT_EQ(columns_of("x y z w\n1 2 3 4\n", swapped), "y,x,z,_");
  EXPECT_THAT(fault("1 2\n3 4\n", swapped), StartsWith("line 1: "));
  EXPECT_THAT(fault("1 2 3\n", {.columns = {"_", "x", "y", "z"}}),
              HasSubstr("3 columns, fewer than --columns names"));
  EXPECT_EQ(fault("1 2 3\n", {.columns = {"x", "y"}}),
            "the columns of a text must have the names x, y and z among them");
  EXPECT_EQ(fault("1 2 3\n", {.columns = {"x", "y", "z", "x"}}), "the column x is there twice");
  EXPECT_EQ(points_of("1 2 3 0 0 1\n", {.columns = {"x", "y", "z", "nx", "ny", "nz"}}), (Points{{1, 2, 3}}));
  EXPECT_EQ(read("1 2 3 0 0 1\n", {.columns = {"x", "y", "z"}}).normals, Points());
  EXPECT_THAT(fault("1 2 3\n", {.separator = TextSeparator::semicolon}), StartsWith("line 1: "));
  EXPECT_EQ(points_of("1 2 3\n1,5 2 3\n"), (Points{{1, 2, 3}, {1.5, 2, 3}}));
  EXPECT_THAT(fault("1 2 3\n1.5 2 3\n", {.decimal = DecimalMark::comma}), StartsWith("line 2: "));
  EXPECT_EQ(points_of("1\t2\t3\t \n", {.separator = TextSeparator::blank}), (Points{{1, 2, 3}}));
  EXPECT_THAT(
      fault("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n", swapped),
      AllOf(HasSubstr(kTextOptions), HasSubstr("do not apply to PCD")));
}

TEST(TextCloud, NormalsOfLengthOneAreFoundByTheirPlace) {
  const Cloud cloud = read("5 6 7 0.6 0 0.8 9\n5 6 8 0 0 -1 9\n");
  EXPECT_EQ(cloud.points, (Points{{5, 6, 7}, {5, 6, 8}}));
  EXPECT_EQ(cloud.normals, (Points{{0.6, 0, 0.8}, {0, 0, -1}}));
  EXPECT_EQ(columns_of("5 6 7 0.6 0 0.8 9\n"), "x,y,z,nx,ny,nz,_");
  EXPECT_EQ(read("5 6 7 0.6 0 0.8\n5 6 8 255 0 0\n").normals, Points());
  const Cloud ignored = read("1;2;3;0,5\n1;2;4;0,5\n");
  EXPECT_EQ(ignored.dialect->decimal, DecimalMark::comma) << "of what is ignored";
  EXPECT_EQ(read("x y z r g b\n5 6 7 0 0 1\n").normals, Points()) << "names decide";
}

std::string ptx_scan(const std::string& size, const std::string& matrix, const std::string& rows) {
  return size + "0 0 0\n1 0 0\n0 1 0\n0 0 1\n" + matrix + rows;
}

TEST(TextCloud, PosesOfPtxScansAreApplied) {
  const std::string moved = "1 0 0 0\n0 1 0 0\n0 0 1 0\n100 0 0 1\n";
  // Rows of points times the matrix: x becomes y, y becomes -x, and then a translation.
  const std::string turned = "0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n";
  const std::string one = ptx_scan("2\n1\n", moved, "-95 5 12 0.5\n-95 5 13 0.5\n");
  EXPECT_EQ(points_of(one), (Points{{5, 5, 12}, {5, 5, 13}}));
  const Cloud both = read(one + ptx_scan("1\n2\n", turned, "1 2 3 0.5 255 255 255\n0 0 0 0.5 0 0 0\n"));
  EXPECT_EQ(both.format, "PTX");
  EXPECT_FALSE(both.dialect);
  ASSERT_EQ(both.points.size(), 4u);
  EXPECT_EQ(both.points[2], (Vec3{8, 21, 33}));
  EXPECT_TRUE(std::isnan(both.points[3][0])) << "a direction without a measurement";

  EXPECT_THAT(fault(one + "1\n"), HasSubstr("ends within the header of scan 2"));
  EXPECT_THAT(fault(one.substr(0, one.rfind('-'))), HasSubstr("scan 1 lacks 1 of its points"));
  EXPECT_THAT(fault(one + "1 2 3 4\n"), StartsWith("line 13: expected the number of columns"));
  EXPECT_THAT(fault(ptx_scan("1\n1\n", "1 0 0 0\n0 1 0 0\n0 0 1 0\n1 0 0 2\n", "1 2 3 4\n")),
              HasSubstr("last column"));
  EXPECT_THAT(fault(ptx_scan("1\n1\n", "1 0 0\n", "1 2 3 4\n")), StartsWith("line 7: expected 4 numbers"));
  EXPECT_THAT(fault(ptx_scan("4294967296\n4294967296\n", moved, "1 2 3 4\n")),
              HasSubstr("more than the file can hold"));
  EXPECT_THAT(fault(ptx_scan("2\n1\n", moved, "1 2 3 4\n1 2 x 4\n")),
              StartsWith("line 12: expected a number, not 'x'"));
  EXPECT_THAT(fault(one, {.columns = {"x", "y", "z"}}), HasSubstr("do not apply to PTX"));
}

TEST(TextCloud, PtsHasSeveralScans) {
  const std::string scans = "2\n1 2 3 -7 255 0 0\n4 5 6 8 0 0 255\n0\n1\n7 8 9 10 1 2 3\n";
  EXPECT_EQ(points_of(scans), (Points{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
  EXPECT_EQ(fault(scans + "3\n1 2 3 4 5 6 7\n"), "ends after 1 of 3 points; it is truncated");
  EXPECT_THAT(fault(scans + "1 2 3 4 5 6 7\n"), StartsWith("line 7: more rows follow"));
}

TEST(TextCloud, WholeNumbersOfPcd) {
  for (const std::size_t size : {1u, 2u, 4u, 8u})
    for (const char type : {'I', 'U'}) {
      const std::string header = fmt::format(
          "VERSION .7\nFIELDS x y z\nSIZE {0} {0} {0}\nTYPE {1} {1} {1}\nWIDTH 2\nHEIGHT 1\nDATA ", size,
          type);
      const Points expected{{1, 2, 3}, {100, type == 'I' ? -5.0 : 250.0, 6}};
      std::string ascii = header + "ascii\n", binary = header + "binary\n";
      for (const Vec3& p : expected) {
        ascii += fmt::format("{} {} {}\n", p[0], p[1], p[2]);
        for (const double x : p) {
          std::string bytes;
          put(bytes, static_cast<std::int64_t>(x));
          binary += bytes.substr(0, size);
        }
      }
      EXPECT_EQ(points_of(ascii), expected);
      EXPECT_EQ(points_of(binary), expected) << type << size;
    }
  std::string big = "VERSION .7\nFIELDS x y z\nSIZE 8 2 1\nTYPE U U U\nWIDTH 1\nHEIGHT 1\nDATA binary\n";
  put(big, std::uint64_t{1} << 63);
  put(big, std::uint16_t{65535});
  put(big, std::uint8_t{255});
  EXPECT_EQ(points_of(big), (Points{{0x1p63, 65535, 255}}));
}

// Random tables, written in all dialects, are read back to the bit.
TEST(TextCloud, TablesInAllDialectsAreReadExactly) {
  std::mt19937 random(7);
  const auto below = [&](std::size_t n) { return random() % n; };
  const auto any_number = [&] {
    const double x = std::uniform_real_distribution<double>(-1, 1)(random);
    return std::ldexp(x, static_cast<int>(below(60)) - 30);
  };
  const std::string separators[] = {" ", "\t", ",", ";", " \t ", ", ", " ; "};
  const std::string ends[] = {"\n", "\r\n", "\r"};
  const std::string prefixes[] = {"", "//", "# ", "#"};
  for (int table = 0; table < 1000; ++table) {
    const std::string separator = separators[below(std::size(separators))], end = ends[below(3)];
    const bool quotes = below(4) == 0;
    const bool comma = (quotes || separator.front() != ',') && below(2) == 0;
    // With normals or not, and further columns: numbers, or words if there are names. In any order.
    std::vector<std::string> names{"x", "y", "z"};
    const bool normals = below(3) == 0;
    if (normals) names.insert(names.end(), {"nx", "ny", "nz"});
    const bool header = below(3) != 0;
    for (std::size_t more = below(header ? 4 : 3); more > 0; --more)
      names.push_back(fmt::format("a{}", more));
    if (header) std::ranges::shuffle(names, random);
    const bool words = header && below(2) == 0;
    // Numbers that all have a mark: whole ones alone may have several meanings.
    const auto text = [&](double x) {
      std::string digits = fmt::format("{}", x);
      if (digits.find_first_of(".") == std::string::npos) {
        const std::size_t exponent = std::min(digits.find('e'), digits.size());
        digits.insert(exponent, ".0");
      }
      if (comma) std::ranges::replace(digits, '.', ',');
      return quotes ? "\"" + digits + "\"" : digits;
    };
    std::string file = below(2) ? "\xEF\xBB\xBF" : "";
    if (below(3) == 0) file += "# a comment" + end;
    if (header) {
      std::string line;
      const bool upper = below(2) == 0;
      for (const std::string& name : names) {
        std::string cell = upper ? name : std::string();
        for (char& c : cell) c = static_cast<char>(std::toupper(c));
        line += (line.empty() ? "" : separator) + (upper ? cell : name);
      }
      file += prefixes[below(4)] + line + end;
    }
    const std::size_t rows = 1 + below(20);
    if (below(4) == 0) file += std::to_string(rows) + end;
    Points points(rows), directions(normals ? rows : 0);
    for (std::size_t i = 0; i < rows; ++i) {
      points[i] = {any_number(), any_number(), any_number()};
      if (normals) {
        const double angle = any_number();
        directions[i] = {std::cos(angle), std::sin(angle), 0};
      }
      std::string line;
      for (const std::string& name : names) {
        const std::size_t at = name.back() - 'x';
        const bool point = name.size() == 1, normal = name[0] == 'n';
        line +=
            (line.empty() ? "" : separator) + (point || normal ? text((normal ? directions : points)[i][at])
                                               : words         ? "w"
                                                               : text(any_number()));
      }
      file += line + (i + 1 < rows || below(2) ? end : "");
    }
    const Cloud cloud = read(file);
    ASSERT_EQ(cloud.points, points) << file;
    ASSERT_EQ(cloud.normals, directions) << file;
    ASSERT_EQ(cloud.dialect->columns.size(), names.size()) << file;
    // What the report says of the file reads it in the same way.
    ASSERT_EQ(points_of(file, *cloud.dialect), points) << file;
  }
}

}  // namespace
}  // namespace sdm
