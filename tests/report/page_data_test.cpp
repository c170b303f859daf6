// The data of report.html that no other file has.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "geometry/vec.h"
#include "io/page/report/area_by_value.h"
#include "io/page/report/fewer_vertices.h"
#include "io/page/report/packed_arrays.h"
#include "io/page/report/worst_places.h"
#include "support/made_up_maps.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using namespace io;

const Field kBump = [](const Vec3& p) { return p[0] - 3 * std::exp(-40 * squared_norm(p - Vec3{0, 1, 0})); };

TEST(WorstPlaces, StartAtTheLargestAndAreApart) {
  const Surface surface(ring(40), {.resolution = 256});
  const auto vertices = at_vertices(surface.mesh(), kBump);
  const DistanceMap map = map_of(surface, kBump);
  const std::vector<Place> places = worst_places(surface, map, vertices);
  ASSERT_GE(places.size(), 3u);
  ASSERT_LE(places.size(), 10u);
  const Extremes all = extremes(surface, map, vertices).value();
  EXPECT_EQ(std::abs(places[0].distance), std::max(std::abs(all.min.distance), std::abs(all.max.distance)));
  const double apart = 0.06 * diagonal(bounds(surface.mesh()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_NEAR(places[i].distance, kBump(places[i].point), 1e-5);
    EXPECT_LE(std::abs(places[i].distance), std::abs(places[i > 0 ? i - 1 : 0].distance));
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE(norm(places[i].point - places[j].point), apart);
    if (places[i].sample == kNone) continue;
    EXPECT_EQ(places[i].point, surface.texel_point(static_cast<std::uint32_t>(places[i].sample)));
  }
}

TEST(WorstPlaces, NeedAValue) {
  const Field none = [](const Vec3&) { return std::nan(""); };
  const Surface surface(ring(6), {.resolution = 64});
  EXPECT_TRUE(worst_places(surface, map_of(surface, none), at_vertices(surface.mesh(), none)).empty());
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
