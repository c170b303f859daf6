// Files of fields, read back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/map_files.h>
#include <sdm/sdm.h>

#include <cstring>
#include <fstream>
#include <sstream>

#include "io/fields/far_signs.h"
#include "support/error_of.h"
#include "support/oracle.h"
#include "support/temporary_folder.h"
#include "volume/scenes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class T>
std::vector<T> numbers(const std::string& bytes, std::size_t at, std::size_t count) {
  std::vector<T> values(count);
  if (at + count * sizeof(T) > bytes.size()) throw std::runtime_error("too few bytes");
  std::memcpy(values.data(), bytes.data() + at, count * sizeof(T));
  return values;
}

void expect_same(const std::vector<float>& found, const std::vector<float>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_EQ(std::memcmp(found.data(), expected.data(), 4 * found.size()), 0);
}

struct FieldFiles : ::testing::Test {
  TemporaryFolder folder;
  Grid grid = make_grid({{-2, -2.5, -1}, {2, 2.5, 1}}, {7, 6, 5});
  DistanceField field = compute_field(Sites(ring(16)), grid, {.max_distance = 1.2, .sites = true});
};

TEST_F(FieldFiles, NumPy) {
  write_field(folder / "field.npy", field);
  const std::string bytes = contents(folder / "field.npy");
  ASSERT_TRUE(bytes.starts_with("\x93NUMPY\x01"));
  const std::string header = bytes.substr(10, 118);
  EXPECT_THAT(header, HasSubstr("'descr': '<f4'"));
  EXPECT_THAT(header, HasSubstr("'fortran_order': True"));
  EXPECT_THAT(header, HasSubstr("'shape': (7, 6, 5)"));
  ASSERT_EQ(bytes.size(), 128 + 4 * grid.size());
  expect_same(numbers<float>(bytes, 128, grid.size()), field.distance);
}

// The value of an attribute of the first element with this text.
std::string attribute(const std::string& xml, const std::string& element, const std::string& name) {
  const std::size_t begin = xml.find(name + "=\"", xml.find(element)) + name.size() + 2;
  return xml.substr(begin, xml.find('"', begin) - begin);
}

template <class T>
std::vector<T> block(const std::string& bytes, const std::string& name) {
  const std::size_t data = bytes.find("<AppendedData encoding=\"raw\">\n_") + 31;
  const std::size_t at = data + std::stoul(attribute(bytes, "Name=\"" + name + '"', "offset"));
  const auto size = numbers<std::uint64_t>(bytes, at, 1)[0];
  return numbers<T>(bytes, at + 8, size / sizeof(T));
}

TEST_F(FieldFiles, Vtk) {
  write_field(folder / "field.VTI", field);
  const std::string bytes = contents(folder / "field.VTI");
  EXPECT_EQ(attribute(bytes, "<VTKFile", "type"), "ImageData");
  EXPECT_EQ(attribute(bytes, "<VTKFile", "header_type"), "UInt64");
  EXPECT_EQ(attribute(bytes, "<ImageData", "WholeExtent"), "0 6 0 5 0 4");
  EXPECT_EQ(attribute(bytes, "<Piece", "Extent"), "0 6 0 5 0 4");
  for (const auto& [name, expected] : {std::pair{"Origin", grid.origin}, {"Spacing", grid.spacing}}) {
    std::istringstream text(attribute(bytes, "<ImageData", name));
    Vec3 v;
    text >> v[0] >> v[1] >> v[2];
    EXPECT_EQ(v, expected) << "read back bit for bit";
  }
  expect_same(block<float>(bytes, "distance"), field.distance);
  EXPECT_EQ(block<std::uint32_t>(bytes, "site"), field.site);
  const auto types = block<std::uint8_t>(bytes, "site_type");
  ASSERT_EQ(types.size(), field.site_type.size());
  for (std::size_t i = 0; i < types.size(); ++i)
    EXPECT_EQ(static_cast<SiteType>(types[i]), field.site_type[i]);
  EXPECT_TRUE(bytes.ends_with("\n</AppendedData>\n</VTKFile>\n"));
}

TEST_F(FieldFiles, ThatCannotBeWrittenAreErrors) {
  EXPECT_THAT(error_of([&] { write_field(folder / "field.raw", field); }), HasSubstr(".vdb (OpenVDB)"));
  EXPECT_THAT(error_of([&] { check_field_format("vdb"); }), HasSubstr("ends in one of"));
  EXPECT_THAT(error_of([&] { write_field(folder / "none" / "field.npy", field); }),
              HasSubstr("cannot write"));
  field.site.pop_back();
  for (const char* name : {"a.npy", "a.vti", "a.vdb"})
    EXPECT_THAT(error_of([&] { write_field(folder / name, field); }), HasSubstr("do not fit its grid"));
  EXPECT_TRUE(folder.empty());
}

TEST(FarSigns, AreThoseOfWindingNumbers) {
  const Mesh nested = joined(sphere(2), flipped(placed(sphere(2), "scale:0.6")));
  const Grid grid = make_grid({{-1.1, -1.2, -1.3}, {1.2, 1.1, 1.4}}, {31, 32, 33});
  for (const Box& box :
       {Box{{-1.1, -1.2, -1.3}, {1.2, 1.1, 1.4}}, Box{{-0.8, -0.1, -0.1}, {1.2, 0.1, 0.1}}}) {
    const Grid part = make_grid(box, {31, 32, 33});
    double widest = 0;
    for (const double h : part.spacing) widest = std::max(widest, h);
    const DistanceField field = compute_field(Sites(nested), part, {.max_distance = widest});
    ASSERT_TRUE(io::has_far_signs(field));
    EXPECT_GT(field.beyond_max_distance, 0u);
    const std::vector<bool> inside = io::far_signs(field);
    for_some_points(part, 2000, [&](std::size_t i, const Vec3& p) {
      if (std::isnan(field.distance[i])) {
        EXPECT_EQ(inside[i], oracle::winding_number(nested, p) != 0);
      }
    });
  }
  EXPECT_FALSE(io::has_far_signs(compute_field(Sites(nested), grid, {.max_distance = 0.05})))
      << "a thin band";
  EXPECT_FALSE(
      io::has_far_signs(compute_field(Sites(nested), grid, {.sign = SignMethod::none, .max_distance = 1})));
}

}  // namespace
}  // namespace sdm::test
