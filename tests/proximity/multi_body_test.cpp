// Many bodies at once, against single pairs and single maps.
#include <gmock/gmock.h>
#include <sdm/execution.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "bodies/pairs/mesh_pair.h"
#include "geometry/boxes.h"
#include "geometry/vec.h"
#include "proximity/crowd.h"
#include "support/allocations.h"
#include "support/map_checks.h"
#include "support/pair_oracle.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

Box random_box(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> side(0, size);
  Box box;
  extend(box, random_point({{0, 0, 0}, {10, 3, 1}}, random));
  extend(box, box.lower + Vec3{side(random), side(random), side(random)});
  return box;
}

TEST(Sweep, FindsTheNearPairs) {
  std::mt19937 random(4);
  Sweep sweep;
  std::size_t near = 0, far = 0;
  for (const std::size_t n : {0u, 1u, 2u, 7u, 60u})
    for (const double reach : {0.0, 0.5, 2.0, kAny}) {
      std::vector<Box> boxes;
      for (std::size_t i = 0; i < n; ++i) boxes.push_back(random_box(random, 1));
      std::vector<Sweep::Pair> expected;
      for (std::uint32_t a = 0; a < n; ++a)
        for (std::uint32_t b = a + 1; b < n; ++b) {
          double squared = 0;
          for (int k = 0; k < 3; ++k) {
            const double gap =
                std::max({0.0, boxes[a].lower[k] - boxes[b].upper[k], boxes[b].lower[k] - boxes[a].upper[k]});
            squared += gap * gap;
          }
          if (std::sqrt(squared) <= reach) expected.push_back({a, b});
        }
      EXPECT_THAT(sweep.near_pairs(boxes, reach), testing::ElementsAreArray(expected)) << n << ' ' << reach;
      near += expected.size();
      far += n * (n - 1) / 2 - expected.size();
    }
  EXPECT_GT(near, 2000u);
  EXPECT_GT(far, 2000u);
}

TEST(Sweep, LosesNoneByRounding) {
  std::mt19937 random(5);
  Sweep sweep;
  for (int i = 0; i < 1000; ++i) {
    const Box boxes[] = {random_box(random, 1), random_box(random, 1)};
    EXPECT_EQ(sweep.near_pairs(boxes, box_distance(boxes[0], boxes[1])).size(), 1u);
  }
}

void expect_same(const BoundedLength& a, const BoundedLength& b) {
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.certainty, b.certainty);
  EXPECT_EQ(a.lower, b.lower);
  EXPECT_EQ(a.upper, b.upper);
  EXPECT_EQ(a.witness, b.witness);
}

/// What ProximityQuery and MultiBodyQuery say of a pair; no depth where the pair does not collide.
struct PairAnswer {
  std::uint32_t first, second;
  BoundedLength separation;
  bool colliding;
  std::optional<BoundedLength> penetration_depth;
};

/// Of all pairs within a distance; fails if the calls contradict each other.
std::vector<PairAnswer> answers_of(MultiBodyQuery& bodies, double max_distance) {
  const auto of = [](const auto& pair) { return std::pair(pair.first, pair.second); };
  std::vector<PairAnswer> answers;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> colliding, listed;
  for (const PairSeparation& pair : bodies.separations(max_distance)) {
    answers.push_back({pair.first, pair.second, pair.separation, pair.colliding, {}});
    if (pair.colliding) colliding.push_back(of(pair));
  }
  for (const BodyPair& pair : bodies.colliding()) listed.push_back(of(pair));
  EXPECT_EQ(colliding, listed);
  for (const PairDepth& pair : bodies.penetration_depths()) {
    const auto same = std::ranges::find_if(answers, [&](const PairAnswer& a) { return of(a) == of(pair); });
    if (same == answers.end() || !same->colliding) {
      ADD_FAILURE() << pair.first << ' ' << pair.second << " have a depth, but do not collide";
      continue;
    }
    same->penetration_depth = pair.penetration_depth;
  }
  return answers;
}

void expect_same(const PairAnswer& a, const PairAnswer& b) {
  expect_same(a.separation, b.separation);
  EXPECT_EQ(a.colliding, b.colliding);
  ASSERT_EQ(a.penetration_depth.has_value(), b.penetration_depth.has_value());
  if (a.penetration_depth) expect_same(*a.penetration_depth, *b.penetration_depth);
}

PairAnswer by_query(const std::vector<Mesh>& meshes, std::uint32_t a, std::uint32_t b) {
  ProximityQuery query(meshes[a], meshes[b]);
  return {a, b, query.separation(), query.colliding(),
          query.colliding() ? query.penetration_depth() : std::nullopt};
}

TEST(MultiBodyQuery, AgreesWithPairQueries) {
  const std::vector<Mesh> meshes = crowd();
  std::vector<PairAnswer> expected;
  for (std::uint32_t a = 0; a < meshes.size(); ++a)
    for (std::uint32_t b = a + 1; b < meshes.size(); ++b) expected.push_back(by_query(meshes, a, b));
  std::size_t colliding = 0;
  for (const double max_distance : {kAny, 2.0, 0.3, 0.01}) {
    SCOPED_TRACE(max_distance);
    MultiBodyQuery bodies(meshes);
    const std::vector<PairAnswer> found = answers_of(bodies, max_distance);
    std::set<std::pair<std::uint32_t, std::uint32_t>> reported;
    for (const PairAnswer& pair : found) {
      const auto same = std::ranges::find_if(
          expected, [&](const PairAnswer& p) { return p.first == pair.first && p.second == pair.second; });
      ASSERT_NE(same, expected.end());
      expect_same(pair, *same);
      EXPECT_TRUE(reported.emplace(pair.first, pair.second).second);
    }
    EXPECT_TRUE(
        std::ranges::is_sorted(found, {}, [](const PairAnswer& p) { return std::pair(p.first, p.second); }));
    EXPECT_LE(reported.size(), bodies.candidate_pairs());
    for (const PairAnswer& pair : expected) {
      const bool within = pair.separation.lower <= max_distance || pair.colliding;
      EXPECT_EQ(reported.contains({pair.first, pair.second}), within) << pair.first << ' ' << pair.second;
    }
    // One body far inside another is nearer to its surface than nothing, but collides.
    EXPECT_TRUE(reported.contains({2, 3}));
    colliding = bodies.colliding().size();
  }
  EXPECT_GE(colliding, 3u);
}

TEST(MultiBodyQuery, AgreesWithAllPairsOfTriangles) {
  const std::vector<Mesh> meshes = crowd();
  MultiBodyQuery bodies(meshes);
  const std::span<const PairSeparation> separations = bodies.separations();
  ASSERT_EQ(separations.size(), meshes.size() * (meshes.size() - 1) / 2);
  int compared = 0;
  for (const PairSeparation& pair : separations) {
    const Mesh &a = meshes[pair.first], &b = meshes[pair.second];
    if (a.triangles.size() * b.triangles.size() > 4000) continue;
    SCOPED_TRACE(std::to_string(pair.first) + ' ' + std::to_string(pair.second));
    const Sites o1(a), o2(b);
    const pairs::MeshPair triangles{internals(o1), internals(o2)};
    double least = kAny;
    for (std::uint32_t f = 0; f < a.triangles.size(); ++f)
      for (std::uint32_t g = 0; g < b.triangles.size(); ++g)
        least = std::min(least, oracle::distance(triangles.face1(f), triangles.face2(g)));
    EXPECT_NEAR(pair.separation.value, least, 1e-6 * scene_diagonal(a, b));
    ++compared;
  }
  EXPECT_GT(compared, 5);
}

TEST(MultiBodyQuery, MapsAreTheMinimumOfSingleMaps) {
  const std::vector<Mesh> meshes = crowd();
  for (const double max_distance : {kAny, 1.0}) {
    const MultiBodyQuery bodies(with_atlases(meshes, 64));
    for (std::uint32_t on = 0; on < meshes.size(); ++on) {
      SCOPED_TRACE(on);
      const Surface& surface = bodies.surface(on);
      const NearestMap nearest = bodies.nearest_map(on, max_distance);
      std::vector<DistanceMap> single(meshes.size());
      for (std::uint32_t to = 0; to < meshes.size(); ++to)
        if (to != on) single[to] = compute_map(surface, bodies.sites(to), {.max_distance = max_distance});
      const double tolerance = 1e-4;  // the crowd is 43 across
      std::size_t beyond = 0, wrong = 0;
      for (std::size_t texel = 0; texel < surface.texel_faces().size(); ++texel) {
        double least = kAny;
        for (std::uint32_t to = 0; to < meshes.size(); ++to)
          if (to != on && !std::isnan(single[to].distance[texel]))
            least = std::min(least, double{std::abs(single[to].distance[texel])});
        const std::uint32_t body = nearest.body[texel];
        const float d = nearest.map.distance[texel];
        if (least == kAny) {
          wrong += body != kNone || !std::isnan(d) || !std::isnan(nearest.map.vector[texel][0]) ||
                   nearest.map.site[texel] != kNone || nearest.map.site_type[texel] != SiteType::none;
          beyond += surface.map_faces()[texel] != kNone;
          continue;
        }
        // The body is one of the nearest, and the values agree with its own map.
        ASSERT_LT(body, meshes.size());
        ASSERT_NE(body, on);
        const Vec3f& v = nearest.map.vector[texel];
        wrong += !(std::abs(std::abs(d) - least) <= tolerance) ||
                 !(std::abs(d - single[body].distance[texel]) <= tolerance) ||
                 !(std::abs(norm(Vec3{v[0], v[1], v[2]}) - std::abs(d)) <= tolerance);
        const Vec3 p = surface.texel_point(static_cast<std::uint32_t>(texel));
        const double to_site = distance_to_site(bodies.sites(body), nearest.map.site_type[texel],
                                                nearest.map.site[texel], p + Vec3{v[0], v[1], v[2]});
        wrong += !(to_site <= tolerance);
      }
      EXPECT_EQ(wrong, 0u);
      EXPECT_EQ(nearest.map.beyond_max_distance, beyond);
    }
  }
}

// The same cube twice, once with a box that comes nearer.
TEST(MultiBodyQuery, MapsNameTheLowestOfEquidistantBodies) {
  const Mesh right = moved(cube(), {4, 0, 0});
  const std::vector<Mesh> meshes{right, joined(right, moved(cube(), {0, 9, 0})), cube(),
                                 moved(cube(), {-6, 0, 0})};
  const MultiBodyQuery bodies(with_atlases(meshes, 64));
  const NearestMap nearest = bodies.nearest_map(2, 2.5);
  std::size_t to_right = 0;
  for (const std::uint32_t body : nearest.body) {
    EXPECT_TRUE(body == 0 || body == kNone) << body;
    to_right += body == 0;
  }
  EXPECT_GT(to_right, 100u);
  EXPECT_EQ(nearest.map.sign.reason, "3 of 3 other bodies are closed and orientable");
}

TEST(MultiBodyQuery, DoesNotDependOnTheOrder) {
  const std::vector<Mesh> meshes = crowd();
  const std::vector<std::uint32_t> order{3, 6, 0, 7, 1, 5, 2, 4};
  std::vector<Mesh> shuffled;
  shuffled.reserve(order.size());
  for (const std::uint32_t i : order) shuffled.push_back(meshes[i]);
  MultiBodyQuery bodies(with_atlases(meshes, 64)), others(with_atlases(shuffled, 64));
  const std::vector<PairAnswer> found = answers_of(bodies, 3), found_by_others = answers_of(others, 3);
  ASSERT_EQ(found.size(), found_by_others.size());
  for (const PairAnswer& pair : found_by_others) {
    const std::uint32_t first = order[pair.first], second = order[pair.second];
    const std::uint32_t a = std::min(first, second), b = std::max(first, second);
    SCOPED_TRACE(std::to_string(a) + ' ' + std::to_string(b));
    const auto same =
        std::ranges::find_if(found, [&](const PairAnswer& p) { return p.first == a && p.second == b; });
    ASSERT_NE(same, found.end());
    EXPECT_NEAR(pair.separation.value, same->separation.value, 1e-12);
    EXPECT_NEAR(pair.separation.lower, same->separation.lower, 1e-12);
    EXPECT_EQ(pair.colliding, same->colliding);
    ASSERT_EQ(pair.penetration_depth.has_value(), same->penetration_depth.has_value());
    if (pair.penetration_depth) {
      EXPECT_NEAR(pair.penetration_depth->value, same->penetration_depth->value, 1e-12);
    }
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    const NearestMap a = others.nearest_map(i, 3), b = bodies.nearest_map(order[i], 3);
    for (std::size_t texel = 0; texel < a.body.size(); ++texel)
      ASSERT_EQ(a.body[texel] == kNone ? kNone : order[a.body[texel]], b.body[texel]);
  }
}

TEST(MultiBodyQuery, RefitsForAnyThreadCount) {
  std::vector<Mesh> meshes = crowd();
  MultiBodyQuery bodies(meshes);
  const auto expect_all_same = [](const std::vector<PairAnswer>& a, const std::vector<PairAnswer>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(std::pair(a[i].first, a[i].second), std::pair(b[i].first, b[i].second));
      expect_same(a[i], b[i]);
    }
  };
  const std::vector<PairAnswer> first = answers_of(bodies, 2);
  for (std::size_t i = 0; i < meshes.size(); ++i) bodies.refit(i, meshes[i].positions);
  expect_all_same(answers_of(bodies, 2), first);

  // All at once, or one after another.
  const Mesh away = moved(meshes[1], {0, 30, 0}), back = moved(meshes[7], {-36, -3, -2});
  std::vector<std::span<const Vec3>> positions(meshes.size());
  positions[1] = away.positions;
  positions[7] = back.positions;
  bodies.refit(positions);
  MultiBodyQuery others(meshes);
  others.refit(7, back.positions);
  others.refit(1, away.positions);
  const std::vector<PairAnswer> now = answers_of(bodies, 2);
  {
    const ThreadLimit alone(1);
    expect_all_same(answers_of(others, 2), now);
  }
  const auto involved = [&](std::uint32_t body) {
    return std::ranges::count_if(now,
                                 [&](const PairAnswer& p) { return p.first == body || p.second == body; });
  };
  EXPECT_EQ(involved(1), 0);
  EXPECT_GT(involved(7), 0);
}

TEST(MultiBodyQuery, AllocatesNothingAfterTheFirstFrames) {
  const ThreadLimit alone(1);  // threads that join later allocate memory of their own
  const std::vector<Mesh> meshes = crowd();
  MultiBodyQuery bodies(meshes);
  std::array<std::vector<std::vector<Vec3>>, 2> frames;
  for (std::size_t f = 0; f < 2; ++f)
    for (std::size_t i = 0; i < meshes.size(); ++i)
      frames[f].push_back(moved(meshes[i], {0.2 * static_cast<double>(f * i % 3), 0, 0}).positions);
  const auto taken = [&] {
    const std::size_t before = allocations();
    for (const auto& frame : frames) {
      for (std::size_t i = 0; i < meshes.size(); ++i) bodies.refit(i, frame[i]);
      (void)bodies.separations(1);
      (void)bodies.penetration_depths();
      (void)bodies.colliding();
    }
    return allocations() - before;
  };
  EXPECT_GT(taken(), 0u);
  (void)taken();  // now each search starts with the closest faces of the frame before
  EXPECT_EQ(taken(), 0u);
}

TEST(MultiBodyQuery, AcceptsFewBodies) {
  MultiBodyQuery none(std::vector<Mesh>{});
  EXPECT_EQ(none.size(), 0u);
  EXPECT_TRUE(none.separations().empty());
  EXPECT_THROW((void)none.nearest_map(0), Error);

  MultiBodyQuery one(with_atlases(std::vector{cube()}, 64));
  EXPECT_TRUE(one.separations().empty());
  const NearestMap nearest = one.nearest_map(0);
  EXPECT_EQ(nearest.map.beyond_max_distance, one.surface(0).sample_texels().size());
  EXPECT_THAT(nearest.body, testing::Each(kNone));
  EXPECT_THAT(nearest.map.site_type, testing::Each(SiteType::none));

  MultiBodyQuery two(with_atlases(std::vector{cube(), moved(cube(), {5, 0, 0})}, 64));
  EXPECT_TRUE(two.separations(2).empty());
  EXPECT_EQ(two.candidate_pairs(), 0u);
  EXPECT_EQ(two.nearest_map(0, 2).map.beyond_max_distance, two.surface(0).sample_texels().size());
  two.refit(1, moved(cube(), {3.5, 0, 0}).positions);
  ASSERT_EQ(two.separations(2).size(), 1u);
  EXPECT_NEAR(two.separations(2)[0].separation.value, 1.5, 1e-6);
}

TEST(MultiBodyQuery, RejectsMismatchedInput) {
  const std::vector<Mesh> meshes{cube(), moved(cube(), {3, 0, 0})};
  MultiBodyQuery bodies(meshes);
  const BoundedLength before = bodies.separations()[0].separation;
  const std::vector<Vec3> few(3), nan(8, Vec3{std::nan(""), 0, 0}), good = moved(cube(), {9, 0, 0}).positions;
  EXPECT_THROW(bodies.refit(2, good), Error);
  EXPECT_THROW(bodies.refit(0, few), Error);
  EXPECT_THROW(bodies.refit(1, nan), Error);
  EXPECT_THROW(bodies.refit(std::vector<std::span<const Vec3>>{good}), Error);
  EXPECT_THROW(bodies.refit(std::vector<std::span<const Vec3>>{good, nan}), Error);
  expect_same(bodies.separations()[0].separation, before);
  EXPECT_THROW((void)bodies.surface(2), Error);
  EXPECT_THROW((void)bodies.surface(1), Error);  // no atlas
  EXPECT_THROW((void)bodies.nearest_map(1), Error);
  EXPECT_THROW((void)bodies.sites(2), Error);
  for (const double wrong : {0.0, -1.0, std::nan("")}) {
    EXPECT_THROW((void)bodies.separations(wrong), Error);
    EXPECT_THROW((void)bodies.nearest_map(0, wrong), Error);
  }
  EXPECT_THROW(bodies.set_filter(2, {}), Error);
  EXPECT_THROW((void)bodies.filter(2), Error);
  EXPECT_THROW(bodies.exclude_pair(0, 2), Error);
  EXPECT_THROW(bodies.include_pair(1, 1), Error);
  try {
    MultiBodyQuery broken(std::vector<Mesh>{cube(), {}});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "body 1: there are no triangles");
  }
}

}  // namespace
}  // namespace sdm::test
