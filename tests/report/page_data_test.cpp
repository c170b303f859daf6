// The data of report.html that no other file has.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sdm/tolerance.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "geometry/vec.h"
#include "io/page/report/area_by_value.h"
#include "io/page/report/fewer_vertices.h"
#include "io/page/report/largest_by_cell.h"
#include "io/page/report/packed_arrays.h"
#include "support/made_up_maps.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using namespace io;

const Field kBump = [](const Vec3& p) { return p[0] - 3 * std::exp(-40 * squared_norm(p - Vec3{0, 1, 0})); };

TEST(LargestByCell, IsTheLargestOfEachNeighbourhood) {
  LargestByCell cells({{0, 0, 0}, {1, 1, 1}});
  for (int i = 0; i < 1000; ++i) {
    const double x = i / 1000.0;
    cells.add({i % 2 == 0 ? x : -x, {x, x, x}, static_cast<std::uint64_t>(i)});
  }
  cells.add({std::nan(""), {0.5, 0.5, 0.5}, 1000});
  const std::vector<CellPlace> places = cells.largest();
  ASSERT_GT(places.size(), 9u);
  EXPECT_EQ(places[0].sample, 999u);
  for (std::size_t i = 1; i < places.size(); ++i) {
    EXPECT_LT(std::abs(places[i].distance), std::abs(places[i - 1].distance));
    EXPECT_EQ(std::abs(places[i].distance), places[i].point[0]);
  }
}

/// The fraction of the area below a limit by both sets of bins, at edges of these.
TEST(AreaByValue, AgreesWithAreasBeyondLimits) {
  const Surface surface(ring(20), {.resolution = 256});
  const DistanceMap map = map_of(surface, [](const Vec3& p) { return std::abs(p[0]); });
  const AreaByValue area = area_by_value(surface, map);
  double sum = 0;
  for (std::size_t i = 0; i < AreaByValue::kBins; ++i) {
    sum += area.area[i];
    if (i % 100 != 99) continue;
    const double edge = area.lo + static_cast<double>(i + 1) * (area.hi - area.lo) / AreaByValue::kBins;
    EXPECT_NEAR(sum, 1 - area_fraction_beyond(surface, map, edge), 1e-5);
  }
  EXPECT_NEAR(sum, 1, 1e-5);
  double by_key = 0;
  for (std::size_t i = 0; i < area.keys.size(); ++i) {
    // The floats of the next key are larger: those whose upper half is that of the first one.
    const float next = std::bit_cast<float>(((area.keys[i] + 1) << 16) ^ 0x80000000u);
    by_key += area.area_of_key[i];
    if (i % 50 != 0) continue;
    EXPECT_NEAR(by_key, 1 - area_fraction_beyond(surface, map, std::nextafter(next, 0.f)), 1e-5);
  }
  EXPECT_NEAR(by_key, 1, 1e-5);
}

// Fractions are of all of the area, as those of a verdict are.
TEST(AreaByValue, CountsWhatHasNoValue) {
  const Surface surface(ring(20), {.resolution = 256});
  const DistanceMap map =
      map_of(surface, [](const Vec3& p) { return p[0] > 0.5 ? std::nan("") : std::abs(p[0]); });
  const AreaByValue area = area_by_value(surface, map);
  double sum = 0;
  for (const float bin : area.area) sum += bin;
  EXPECT_GT(area.without_value, 0.1);
  EXPECT_NEAR(sum + area.without_value, 1, 1e-5);
  EXPECT_NEAR(area.without_value, tolerance_shares(surface, map, Tolerance(9), 0).without_value, 1e-6);
}

TEST(FewerVertices, AreVerticesWithTheirDistances) {
  const Mesh mesh = ring(100);
  const auto distances = at_vertices(mesh, kBump);
  std::map<Vec3, float> of_mesh;
  for (std::size_t v = 0; v < distances.size(); ++v) of_mesh[mesh.positions[v]] = distances[v];
  for (const std::size_t most : {5000, 500}) {
    const FewerVertices fewer = fewer_vertices(mesh, distances, most);
    EXPECT_LE(fewer.mesh.triangles.size(), most);
    EXPECT_GT(fewer.mesh.triangles.size(), most / 3);
    ASSERT_EQ(fewer.mesh.positions.size(), fewer.distances.size());
    float largest = 0;
    for (std::size_t v = 0; v < fewer.distances.size(); ++v) {
      const auto original = of_mesh.find(fewer.mesh.positions[v]);
      ASSERT_NE(original, of_mesh.end());
      EXPECT_EQ(original->second, fewer.distances[v]);
      largest = std::max(largest, std::abs(fewer.distances[v]));
    }
    EXPECT_EQ(largest,
              std::abs(*std::ranges::max_element(distances, {}, [](float d) { return std::abs(d); })));
    std::uint32_t next = 0;  // in the order of their first use
    for (const Triangle& triangle : fewer.mesh.triangles)
      for (const std::uint32_t v : triangle) {
        ASSERT_LE(v, next);
        if (v == next) ++next;
      }
  }
}

TEST(FewerVertices, EndForFlatAndEmptyMeshes) {
  const Mesh flat{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}, {}};
  EXPECT_LE(fewer_vertices(flat, std::vector<float>(3, 1.f), 0).mesh.triangles.size(), 0u);
  EXPECT_EQ(fewer_vertices(square(1, 0), std::vector<float>(4, std::nanf("")), 1).mesh.triangles.size(), 0u);
}

TEST(Base64, MatchesTheStandardsExamples) {
  const auto of = [](std::string_view text) {
    return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace sdm::test
