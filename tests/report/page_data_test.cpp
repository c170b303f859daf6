// The data of report.html that no other file has.
#include <gtest/gtest.h>

#include <sdm/tolerance.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <random>

#include "io/page/report/area_by_value.h"
#include "io/page/report/face_walk.h"
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
    const double edge =
        area.lower + static_cast<double>(i + 1) * (area.upper - area.lower) / AreaByValue::kBins;
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

TEST(Base85, IsOfDigitsThatEndNoElement) {
  const auto of = [](std::vector<std::uint8_t> bytes) { return base85(bytes); };
  EXPECT_EQ(of({}), "");
  EXPECT_EQ(of({0, 0, 0, 1}), "####$");
  EXPECT_EQ(of({0, 0, 0, 25}), "####=");  // the digit 25 would be <
  EXPECT_EQ(of({1}), of({1, 0, 0, 0}));
  EXPECT_EQ(of({255, 255, 255, 255}), "v:Z/#");
  std::vector<std::uint8_t> all;
  std::mt19937 random(1);
  for (int i = 0; i < 4000; ++i) all.push_back(static_cast<std::uint8_t>(random()));
  const std::string text = base85(all);
  EXPECT_EQ(text.size(), 5000u);
  EXPECT_EQ(text.find('<'), std::string::npos);
}

/// The corners of each triangle, the smallest first, as they turn.
std::vector<Triangle> as_they_turn(std::vector<Triangle> triangles) {
  for (Triangle& t : triangles) std::ranges::rotate(t, std::ranges::min_element(t));
  std::ranges::sort(triangles);
  return triangles;
}

TEST(FaceWalk, HasEveryTriangleOnceBesideOneBefore) {
  Mesh mesh = ring(20);
  const std::size_t closed = mesh.triangles.size();
  for (const Triangle& t : square(2, 1).triangles) {  // another component
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  mesh.positions.resize(mesh.positions.size() + 4);
  std::ranges::shuffle(mesh.triangles.begin(), mesh.triangles.begin() + static_cast<std::ptrdiff_t>(closed),
                       std::mt19937(2));
  const FaceWalk walk = walk_over(mesh.triangles, mesh.positions.size());
  std::vector<Triangle> given;
  for (std::size_t i = 0; i < walk.triangles.size(); ++i) {
    Triangle t = walk.triangles[i];
    for (std::uint32_t& v : t) v = walk.vertex[v];
    given.push_back(t);
    EXPECT_EQ(as_they_turn({t}), as_they_turn({mesh.triangles[walk.from[i]]}));
  }
  EXPECT_EQ(as_they_turn(given), as_they_turn(mesh.triangles));

  std::uint32_t next = 0;
  std::size_t beside = 0;
  const auto guesses = guesses_of(walk.triangles);
  ASSERT_EQ(guesses.size(), walk.vertex.size());
  for (const Triangle& t : walk.triangles)
    for (const std::uint32_t v : t) {
      ASSERT_LE(v, next);
      if (v < next) continue;
      ++next;
      for (const std::uint32_t from : guesses[v]) EXPECT_TRUE(from < v || (v == 0 && from == kNone));
      beside += guesses[v][0] != guesses[v][1] ? 1 : 0;
    }
  EXPECT_GT(beside, guesses.size() - 8) << "most numbers are guessed over an edge";
}

}  // namespace
}  // namespace sdm::test
