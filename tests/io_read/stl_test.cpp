// STL text in all the layouts that programs write, and binary STL whose header does not fit the file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/mesh_files.h>

#include "io_read/writers.h"
#include "support/matches.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

MeshFile file_of(std::string_view contents) {
  return read_mesh_file(write_file("a.stl", contents));
}

void expect_cube(std::string_view contents) {
  EXPECT_EQ(corner_positions(read_as("a.stl", contents)), corner_positions(cube()))
      << contents.substr(0, 300);
}

std::string replaced(const std::string& text, const char* pattern, const std::string& by) {
  std::string result;
  std::size_t at = 0;
  for (const Match& match : matches(text, pattern)) {
    result += text.substr(at, match.begin - at) + by;
    at = match.end;
  }
  return result + text.substr(at);
}

std::string cube_text() {
  return stl_text(cube());
}

TEST(StlText, LinesDoNotMatter) {
  const std::string text = cube_text();
  expect_cube(replaced(text, "\n *outer", " outer"));
  expect_cube(replaced(text, "\n *outer loop\n *vertex", " outer loop vertex"));
  expect_cube(replaced(text, "\n *vertex", " vertex"));
  expect_cube(replaced(text, "\n *", " "));  // all on one line
  expect_cube(replaced(text, " +", "\n"));   // each word on a line of its own
  expect_cube(replaced(text, "\n", "\r"));
  expect_cube(replaced(text, "\n", "\r\n\r\n"));
  expect_cube("\xEF\xBB\xBF" + text);
}

TEST(StlText, WordsMayBeApartOrInUpperCase) {
  const std::string text = cube_text();
  expect_cube(replaced(text, "endsolid", "end solid"));
  expect_cube(replaced(text, "endfacet", "end facet"));
  expect_cube(replaced(text, "endloop", "end loop"));
  expect_cube(replaced(replaced(text, "end", "end "), "\n *", " "));
  expect_cube(replaced(text, "end", "END "));
  expect_cube(replaced(replaced(replaced(text, "vertex", "VERTEX"), "solid", "Solid"), "facet", "Facet"));
  expect_cube(replaced(text, " *endfacet\n", ""));
}

TEST(StlText, NormalsMayHaveAnyForm) {
  for (const char* normal : {"facet normal nan nan nan", "facet normal -nan(ind) 1.#QNAN 0", "facet normal",
                             "facet", "facet normal 1e400 0 0", "facet normal 0 0"})
    expect_cube(replaced(cube_text(), "facet normal.*", normal));
}

TEST(StlText, StatementsBetweenFacetsAreSkipped) {
  expect_cube(replaced(cube_text(), "endfacet", "endfacet\ncolor 0.5 0.5 vertex"));
}

TEST(StlText, NamesMayContainKeywords) {
  for (const char* name : {"facet", "facet cover", "the facet normal to it", "outer loop", "solid",
                           "solid solid", "endsolid", "end solid", "vertex 1 2 3", "part no 5"}) {
    const std::string text = "solid " + std::string(name) + "\n" +
                             replaced(cube_text(), "(end)?solid.*\n", "") + "endsolid " + name + "\n";
    for (const std::string& all : {text, replaced(text, "\n *", " "), text + text}) {
      const MeshFile file = file_of(all);
      EXPECT_EQ(file.mesh.triangles.size(), all.size() == 2 * text.size() ? 24u : 12u) << all;
      ASSERT_EQ(file.names.size(), 1u) << name;
      EXPECT_THAT(file.names[0].names, ElementsAre(name)) << all;
      EXPECT_THAT(file.notes, IsEmpty()) << all;
    }
  }
}

TEST(StlText, SeveralSolidsOnOneLine) {
  const std::string facet =
      " facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet ";
  for (const char* end : {"endsolid", "endsolid a part", "end solid a part"}) {
    const MeshFile file = file_of("solid a part" + facet + end + " solid b" + facet + facet + "endsolid b");
    ASSERT_EQ(file.names.size(), 1u);
    EXPECT_THAT(file.names[0].names, ElementsAre("a part", "b")) << end;
    EXPECT_THAT(file.names[0].of_face, ElementsAre(0, 1, 1)) << end;
  }
}

TEST(StlText, WithoutItsEndIsReadWithANote) {
  const std::string text = cube_text(), open = text.substr(0, text.rfind("endsolid"));
  expect_cube(open);
  EXPECT_THAT(file_of(open).notes, ElementsAre(HasSubstr("without endsolid")));
  EXPECT_THAT(file_of(text).notes, IsEmpty());
}

// Whatever is cut off, all facets that are complete are read, or the file is refused.
TEST(StlText, CutWithinAFacetIsTruncated) {
  const std::string text = cube_text(), end = "endloop";
  for (std::size_t length = 0; length < text.rfind(end); ++length) {
    const std::string cut = text.substr(0, length);
    const std::size_t last = cut.rfind(end);
    const bool is_whole = last != std::string::npos && cut.find("\n  facet", last) == std::string::npos;
    const std::string fault = fault_of("a.stl", cut);
    if (is_whole)
      EXPECT_EQ(fault, "") << cut;
    else
      EXPECT_NE(fault, "") << cut;
  }
  EXPECT_THAT(fault_of("a.stl", text.substr(0, text.rfind("vertex"))), HasSubstr("truncated"));
}

TEST(StlText, FaultsNameTheLine) {
  const auto expect_fault = [](const std::string& contents, const char* fault) {
    EXPECT_THAT(fault_of("a.stl", contents), HasSubstr(fault)) << contents;
  };
  const std::string start = "solid a\nfacet normal 0 0 1\n";
  expect_fault("solid\nvertex 0 0 0\n", "line 2: a vertex outside a loop");
  expect_fault(start + "outer loop\nvertex 0 0 0\nvertx 1 0 0\n",
               "line 5: expected vertex or endloop, not 'vertx'");
  expect_fault(start + "outer loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n", "line 6: a facet has 2 vertices");
  expect_fault(start + "outer loop\nvertex 0 0\nvertex 1 0 0\n", "line 5: expected a number, not 'vertex'");
  expect_fault(start + "outer loop\nfacet normal 0 0 1\n", "line 4: a facet begins within a loop");
  expect_fault(start + "outer loop\nouter loop\n", "line 4: a loop begins within a loop");
  expect_fault(start + "facet normal 0 0 1\n", "line 3: the facet before this one has no loop");
  expect_fault(start + "endloop\n", "line 3: endloop outside a loop");
  expect_fault(start + "endfacet\n", "line 3: a facet has no loop");
  expect_fault(start + "endsolid\n", "line 3: a solid ends within a facet");
  expect_fault(start + "solid\n", "line 3: a solid begins within a facet");
  expect_fault(start + "inner loop\n", "line 3: expected outer loop or endfacet, not 'inner'");
}

std::string cube_with_count(std::uint32_t count) {
  std::string bytes = stl_binary(cube()), number;
  put(number, count);
  return bytes.replace(80, 4, number);
}

TEST(StlBinary, CountsThatAreUnknownOrTooLowGiveWayToTheSize) {
  for (const std::uint32_t count : {0u, 0xFFFFFFFFu, 11u, 1u}) {
    expect_cube(cube_with_count(count));
    EXPECT_THAT(file_of(cube_with_count(count)).notes,
                ElementsAre("the header declares " + std::to_string(count) +
                            " triangles, but the file has 12, which are read"));
  }
  EXPECT_THAT(file_of(cube_with_count(12)).notes, IsEmpty());
}

TEST(StlBinary, FewerTrianglesThanDeclaredAreAFault) {
  for (const std::uint32_t count : {13u, 1000u, 0xFFFFFFFEu, 0x80000000u})
    EXPECT_THAT(fault_of("a.stl", cube_with_count(count)),
                HasSubstr("declares " + std::to_string(count) + " triangles, more than the file"));
  // Cut within a triangle, an unknown count does not hide it.
  for (const std::uint32_t count : {0u, 12u, 0xFFFFFFFFu}) {
    std::string cut = cube_with_count(count);
    cut.resize(cut.size() - 20);
    EXPECT_THAT(fault_of("a.stl", cut), HasSubstr("truncated"));
    cut.resize(84);
    EXPECT_NE(fault_of("a.stl", cut), "");
  }
}

TEST(StlBinary, BytesAfterTheTrianglesAreNoted) {
  expect_cube(stl_binary(cube()) + "spare");
  EXPECT_THAT(file_of(stl_binary(cube()) + "spare").notes,
              ElementsAre("5 bytes after the 12 declared triangles are ignored"));
}

}  // namespace
}  // namespace sdm::test
