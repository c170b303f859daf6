#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/execution.h>

#include <array>
#include <numeric>
#include <random>
#include <set>
#include <thread>
#include <vector>

#include "core/arrays/check_rows.h"
#include "core/arrays/rows.h"
#include "core/disjoint_sets.h"
#include "core/lazy/once.h"
#include "core/memory.h"
#include "core/platform.h"
#include "geometry/barycentric.h"
#include "geometry/boxes.h"
#include "geometry/spatial_order.h"
#include "geometry/vec.h"

namespace sdm {
namespace {

TEST(Memory, RefusesWhatTheMachineDoesNotHave) {
  EXPECT_NO_THROW(require_memory(1 << 20, "a small map"));
  EXPECT_GT(available_memory(), std::size_t{1} << 20);
  try {
    require_memory(std::size_t{1} << 60, "an absurd map");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("an absurd map needs 1.15e+09 GB"));
  }
}

TEST(Memory, NamesWhatThereIsNotEnoughMemoryFor) {
  const Error error = out_of_memory("a map of 64² texels");
  EXPECT_STREQ(error.what(), "a map of 64² texels: not enough memory");
}

// Against labels that are rewritten at every union.
TEST(DisjointSets, AreTheComponentsWhateverTheOrderOfTheUnions) {
  std::mt19937 random(11);
  for (const std::uint32_t count : {1u, 2u, 50u, 2000u}) {
    std::uniform_int_distribution<std::uint32_t> any(0, count - 1);
    std::vector<std::array<std::uint32_t, 2>> pairs(count / 2);
    for (auto& [a, b] : pairs) {
      a = any(random);
      b = any(random);
    }
    std::vector<std::uint32_t> smallest(count);
    std::iota(smallest.begin(), smallest.end(), 0u);
    for (const auto& [a, b] : pairs) {
      const auto [to, from] = std::minmax({smallest[a], smallest[b]});
      std::ranges::replace(smallest, from, to);
    }
    DisjointSets sets(7);
    sets.unite(0, 6);
    for (int order = 0; order < 3; ++order) {
      std::ranges::shuffle(pairs, random);
      sets.reset(count);
      for (const auto& [a, b] : pairs) sets.unite(a, b);
      for (std::uint32_t x = 0; x < count; ++x) ASSERT_EQ(sets.find(x), smallest[x]);
    }
  }
}

TEST(CompressedRows, KeepTheOrderWithinARow) {
  std::mt19937 random(12);
  std::uniform_int_distribution<std::size_t> any(0, 99);
  std::vector<std::vector<int>> expected(100);
  std::vector<std::size_t> row_of(1000);
  for (int i = 0; i < 1000; ++i) {
    row_of[i] = any(random) / 2 * 2;  // every other row stays empty
    expected[row_of[i]].push_back(i);
  }
  const auto check = [&](const auto& rows) {
    ASSERT_EQ(rows.size(), expected.size());
    for (std::size_t r = 0; r < rows.size(); ++r)
      EXPECT_THAT(rows.of(r), testing::ElementsAreArray(expected[r]));
  };
  const auto visit = [&](const auto& put) {
    for (int i = 0; i < 1000; ++i) put(row_of[i], i);
  };
  check(make_rows<int>(100, visit));
  check(make_rows<int, std::size_t>(100, visit));
  EXPECT_EQ(make_rows<int>(0, [](const auto&) {}).size(), 0u);
}

TEST(RowCheck, AcceptsNothingButTheRowsOfTheItems) {
  const std::vector<std::uint32_t> row_of{2, 0, 2, 3, 0, 2};  // row 1 is empty
  const auto visit = [&](const auto& put) {
    for (std::uint32_t i = 0; i < row_of.size(); ++i) put(row_of[i], 10 + i);
  };
  const auto same = [&](const CompressedRows<std::uint32_t>& rows) {
    RowCheck check(rows);
    for (std::uint32_t i = 0; i < row_of.size(); ++i)
      if (!check.put(row_of[i], 10 + i)) return false;
    return check.complete();
  };
  const auto rows = make_rows<std::uint32_t>(4, visit);
  EXPECT_TRUE(same(rows));
  const auto with = [&](auto member, std::size_t i, std::uint32_t value) {
    auto changed = rows;
    (changed.*member)[i] = value;
    return changed;
  };
  using Rows = CompressedRows<std::uint32_t>;
  for (const std::uint32_t value : {0u, 1u, 3u, 6u, 12u, 0x80000000u, ~0u}) {
    for (std::size_t i = 0; i < rows.offsets.size(); ++i)
      EXPECT_EQ(same(with(&Rows::offsets, i, value)), rows.offsets[i] == value) << i << ' ' << value;
    for (std::size_t i = 0; i < rows.items.size(); ++i)
      EXPECT_EQ(same(with(&Rows::items, i, value)), rows.items[i] == value) << i << ' ' << value;
  }
  auto longer = rows;
  longer.items.push_back(0);
  EXPECT_FALSE(same(longer));
}

// The groups as their smallest members, by all pairs of boxes.
std::vector<std::uint32_t> groups_by_pairs(const std::vector<Box>& boxes) {
  const auto n = static_cast<std::uint32_t>(boxes.size());
  DisjointSets groups(n);
  for (std::uint32_t a = 0; a < n; ++a)
    for (std::uint32_t b = a + 1; b < n; ++b)
      if (box_distance(boxes[a], boxes[b]) == 0) groups.unite(a, b);
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < n; ++i) result.push_back(groups.find(i));
  return result;
}

std::vector<std::uint32_t> found_groups(const std::vector<Box>& boxes) {
  BoxGroups finder;
  DisjointSets groups;
  finder.find(std::vector<Box>(7, Box{{0, 0, 0}, {1, 1, 1}}), groups);  // whose memory is used again
  finder.find(boxes, groups);
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) result.push_back(groups.find(i));
  return result;
}

TEST(BoxGroups, AreThoseOfAllPairs) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> u(-1, 1);
  std::set<std::size_t> counts;
  for (const double size : {0.0, 0.05, 0.2, 0.5, 2.0})
    for (const std::size_t n : {0u, 1u, 2u, 5u, 60u, 300u}) {
      std::vector<Box> boxes(n);
      for (Box& box : boxes) {
        const Vec3 p{u(random), 3 * u(random), u(random)};
        extend(box, p);
        extend(box, p + size * Vec3{u(random), u(random), u(random)});
      }
      const auto groups = found_groups(boxes);
      EXPECT_EQ(groups, groups_by_pairs(boxes)) << n << ' ' << size;
      counts.insert(std::set(groups.begin(), groups.end()).size());
    }
  EXPECT_GT(counts.size(), 10u);
}

TEST(BoxGroups, TouchingBoxesMeet) {
  EXPECT_EQ(found_groups({{{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {2, 2, 2}}, {{3, 0, 0}, {4, 1, 1}}}),
            (std::vector<std::uint32_t>{0, 0, 2}));
}

// Each of these has 2.5e9 pairs of boxes that meet: finding each of them would take minutes.
TEST(BoxGroups, CostsNoMoreWhereAllMeet) {
  constexpr std::uint32_t kBoxes = 100'000;
  const std::vector<std::uint32_t> one_group(kBoxes, 0);
  EXPECT_EQ(found_groups(std::vector<Box>(kBoxes, Box{{0, 0, 0}, {1, 1, 1}})), one_group);
  std::vector<Box> strips;
  for (std::uint32_t i = 0; i < kBoxes / 2; ++i) {
    const double at = 2.0 * i, end = kBoxes;
    strips.push_back({{0, at, 0}, {end, at + 1, 0}});
    strips.push_back({{at, 0, 0}, {at + 1, end, 0}});
  }
  EXPECT_EQ(found_groups(strips), one_group);
}

TEST(BoxDistance, IsTheLeastDistanceOfPointsOfTheBoxes) {
  const Box a{{0, 0, 0}, {1, 1, 1}};
  EXPECT_EQ(gap(a, Box{{1, 1, 1}, {2, 2, 2}}), (Vec3{0, 0, 0}));
  EXPECT_EQ(gap(a, Box{{3, -4, 0.2}, {4, -3, 0.4}}), (Vec3{2, 3, 0}));
  EXPECT_TRUE(overlap(a, {{1, 1, 1}, {2, 2, 2}}));
  EXPECT_FALSE(overlap(a, {{0, 0, std::nextafter(1.0, 2.0)}, {2, 2, 2}}));
  const double distance = box_distance(a, {{4, 5, 0}, {6, 7, 1}});
  EXPECT_LE(distance, 5);
  EXPECT_GT(distance, 5 - 1e-13);
}

TEST(SpatialOrder, IsAPermutationThatKeepsNeighboursTogether) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1e5, 1e5);
  std::vector<Vec3> points(20000);
  for (Vec3& p : points) p = {u(random), u(random), u(random)};
  const auto length = [&](const std::vector<std::uint32_t>& order) {
    double sum = 0;
    for (std::size_t i = 1; i < order.size(); ++i) sum += norm(points[order[i]] - points[order[i - 1]]);
    return sum;
  };
  std::vector<std::uint32_t> as_is(points.size());
  std::iota(as_is.begin(), as_is.end(), 0u);
  std::vector<std::uint32_t> order = spatial_order(points);
  EXPECT_LT(length(order), 0.2 * length(as_is));
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, as_is);
}

// Of a grid, every aligned 16·4^k are a square.
TEST(SpatialOrder, AlignedPacketsAreCompact) {
  std::vector<Vec3> points;
  for (int x = 0; x < 64; ++x)
    for (int y = 0; y < 64; ++y) points.push_back({1000.0 + x, -1.0 * y, 5});
  std::shuffle(points.begin(), points.end(), std::mt19937(3));
  for (const unsigned threads : {1u, 4u}) {
    const ThreadLimit limit(threads);
    const std::vector<std::uint32_t> order = spatial_order(points);
    double side = 4;
    for (std::size_t size = 16; size <= points.size(); size *= 4, side *= 2)
      for (std::size_t first = 0; first < order.size(); first += size) {
        Box box;
        for (std::size_t i = first; i < first + size; ++i) extend(box, points[order[i]]);
        EXPECT_EQ(box.upper - box.lower, (Vec3{side - 1, side - 1, 0}));
      }
  }
}

// The halves are determined by coordinates and indices, and so is the order in a packet, which a selection
// would leave to the standard library.
TEST(SpatialOrder, IsAscendingInEachPacket) {
  std::mt19937 random(8);
  std::uniform_int_distribution<int> u(0, 9);  // many points at the same place
  std::vector<Vec3> points(3001);
  for (Vec3& p : points) p = {1.0 * u(random), 1.0 * u(random), 1.0 * u(random)};
  const std::vector<std::uint32_t> order = spatial_order(points);
  for (std::size_t first = 0; first < order.size(); first += 16)
    EXPECT_TRUE(std::ranges::is_sorted(
        std::span(order).subspan(first, std::min<std::size_t>(16, order.size() - first))));
}

// std::call_once of GCC for Windows waited forever in the second call.
TEST(Once, CallsAgainAfterAnException) {
  Once once;
  int calls = 0;
  const auto make = [&] {
    if (++calls < 3) throw Error("not yet");
  };
  EXPECT_THROW(once.call(make), Error);
  EXPECT_THROW(once.call(make), Error);
  once.call(make);
  once.call(make);
  EXPECT_EQ(calls, 3);
}

TEST(Once, IsCalledByOneOfManyThreads) {
  Once once;
  int calls = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i)
    threads.emplace_back([&] {
      once.call([&] { ++calls; });
      EXPECT_EQ(calls, 1);
    });
  for (std::thread& thread : threads) thread.join();
}

// GCC for Windows freed the memory of these objects first.
TEST(ThreadLocal, ObjectsAreDestroyedBeforeTheirMemoryIsFreed) {
  struct Watched {
    std::array<int, 100> numbers{};
    std::vector<int>* seen = nullptr;
    ~Watched() {
      // Takes what has been freed, of about its size.
      for (std::size_t size = 4 * 64; size < 4 * 128; ++size) seen->push_back(std::vector<char>(size, -1)[0]);
      seen->assign(numbers.begin(), numbers.end());
    }
  };
  for (int round = 0; round < 3; ++round) {
    std::vector<int> seen;
    std::thread([&] {
      thread_local Watched watched;
      watched.numbers.fill(7);
      watched.seen = &seen;
    }).join();
    EXPECT_EQ(seen, std::vector<int>(100, 7));
  }
}

TEST(SpatialOrder, TakesNoPointsAndEqualPoints) {
  EXPECT_TRUE(spatial_order({}).empty());
  EXPECT_EQ(spatial_order(std::vector<Vec3>(5, Vec3{3, 3, 3})).size(), 5u);
}

// Weights of needles and caps are ratios of areas that may be rounding errors; their point is accurate.
TEST(Barycentric, GivesThePointInTrianglesOfAnyShape) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1), exponent(-20, 0), signed_unit(-1, 1);
  const auto anywhere = [&] { return Vec3{signed_unit(random), signed_unit(random), signed_unit(random)}; };
  for (int i = 0; i < 200'000; ++i) {
    const Vec3 a = anywhere(), b = anywhere();
    // The third corner is near a point of the line through the others, by any factor of the side.
    const double t = i % 3 == 0 ? std::pow(10, exponent(random)) : 2 * signed_unit(random);
    std::array corners{a, b, a + t * (b - a) + std::pow(10, exponent(random)) * anywhere()};
    if (i % 7 == 0) corners[2] = corners[i % 2];
    std::shuffle(corners.begin(), corners.end(), random);
    Vec3 given{unit(random), unit(random), unit(random)};
    for (double& w : given)
      if (unit(random) < 0.3) w = 0;  // on sides and corners
    const double sum = given[0] + given[1] + given[2];
    given = sum > 0 ? (1 / sum) * given : Vec3{0, 1, 0};
    const auto point = [&](const Vec3& w) {
      return w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2];
    };
    const Vec3 p = point(given), w = barycentric(corners[0], corners[1], corners[2], p);
    ASSERT_GE(std::ranges::min(w), 0);
    ASSERT_NEAR(w[0] + w[1] + w[2], 1, 1e-15);
    ASSERT_LE(norm(point(w) - p), 1e-14) << i;
  }
  EXPECT_EQ(barycentric({1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}), (Vec3{1, 0, 0}));
}

}  // namespace
}  // namespace sdm
