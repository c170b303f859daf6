// Matches of texels: the point of O2 that belongs to each.
#include <gtest/gtest.h>
#include <sdm/match.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "map/terrain.h"
#include "support/error_of.h"
#include "support/match_pairs.h"
#include "support/oracle.h"
#include "support/owned_texels.h"
#include "support/ray_oracle.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

bool allowed(const Vec3& n, const Vec3& m, double angle, double slack) {
  if (n == Vec3{} || m == Vec3{}) return false;
  return dot(n, m) > (angle == 90 ? 0 : std::cos(angle * std::numbers::pi / 180)) + slack;
}

Vec3 point_of(const Mesh& mesh, const SurfacePoint& at) {
  Vec3 sum{};
  for (int k = 0; k < 3; ++k) sum += at.barycentric[k] * mesh.positions[mesh.triangles[at.face][k]];
  return sum;
}

/// The least distance to the faces for which use(face).
template <class Use>
double least_distance(const Mesh& mesh, const Vec3& q, const Use& use) {
  double least = kInfinity;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    if (!use(f)) continue;
    const auto& [a, b, c] = mesh.triangles[f];
    least = std::min(least, oracle::distance(q, mesh.positions[a], mesh.positions[b], mesh.positions[c]));
  }
  return least;
}

/// Parameters of a line in a triangle, by Möller and Trumbore, with weights of at least `inside`.
std::optional<double> on_line(const Mesh& mesh, std::uint32_t face, const Vec3& p, const Vec3& u,
                              double inside) {
  const auto& [ia, ib, ic] = mesh.triangles[face];
  const Vec3 ab = mesh.positions[ib] - mesh.positions[ia], ac = mesh.positions[ic] - mesh.positions[ia];
  const Vec3 across = cross(u, ac), from = p - mesh.positions[ia];
  const double area = dot(ab, across);
  if (area == 0) return {};
  const double v = dot(from, across) / area, w = dot(u, cross(from, ab)) / area;
  if (!(v >= inside && w >= inside && 1 - v - w >= inside)) return {};
  return dot(ac, cross(from, ab)) / area;
}

/// The normal of a vertex: the mean of its faces', weighted by their angles.
std::vector<Vec3> normals_of_vertices(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size());
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Vec3& at = mesh.positions[mesh.triangles[f][k]];
      const Vec3 a = normalized(mesh.positions[mesh.triangles[f][(k + 1) % 3]] - at),
                 b = normalized(mesh.positions[mesh.triangles[f][(k + 2) % 3]] - at);
      normals[mesh.triangles[f][k]] += std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * normal_of(mesh, f);
    }
  for (Vec3& n : normals) n = normalized(n);
  return normals;
}

/// The interpolated normal of an owned texel, with weights from areas in the atlas.
Vec3 normal_at_texel(const Surface& surface, const std::vector<Vec3>& normals, std::uint32_t texel) {
  const std::uint32_t face = surface.map_faces()[texel], n = surface.resolution();
  const auto corners = surface.atlas_corners(face);
  const Vec2 at{texel % n + 0.5, texel / n + 0.5};
  const double area = cross(corners[1] - corners[0], corners[2] - corners[0]);
  Vec3 sum{};
  for (int k = 0; k < 3; ++k) {
    const Vec2 &a = corners[(k + 1) % 3], &b = corners[(k + 2) % 3];
    sum += cross(a - at, b - at) / area * normals[surface.mesh().triangles[face][k]];
  }
  return normalized(sum);
}

TEST(Match, ClosestAndFacingPointsAreThoseOfBruteForceAtEveryTexelOf40Pairs) {
  const auto pairs = pairs_to_match();
  ASSERT_EQ(pairs.size(), 40U);
  std::size_t texels = 0, wrong = 0, away = 0;
  for (const auto& [o1, o2] : pairs) {
    const Surface surface(o1, {.resolution = 24});
    const Sites sites(o2);
    const double angle = texels % 2 == 0 ? 90 : 25,
                 error = 2e-6 * norm(bounds(o1).upper - bounds(o2).lower) + 1e-6;
    const TexelMatches closest = match_texels(surface, sites, {.method = MatchMethod::closest});
    const TexelMatches facing = match_texels(surface, sites, {.facing = angle});
    for (std::size_t i = 0; i < closest.kind.size(); ++i)
      wrong += (closest.kind[i] == MatchKind::none) != (surface.map_faces()[i] == kNone);
    for (const std::uint32_t texel : test::owned_texels(surface)) {
      ++texels;
      const Vec3 q = surface.texel_point(texel);
      const Vec3 normal = normal_of(o1, surface.map_faces()[texel]);
      const double any = least_distance(o2, q, [](std::uint32_t) { return true; });
      wrong += closest.kind[texel] != MatchKind::closest;
      wrong += !(std::abs(norm(point_of(o2, closest.point(texel)) - q) - any) <= error);
      const auto least = [&](double slack) {
        return least_distance(
            o2, q, [&](std::uint32_t f) { return allowed(normal_of(o2, f), normal, angle, slack); });
      };
      const double at_most = least(1e-9), at_least = least(-1e-9);
      if (facing.kind[texel] == MatchKind::facing_away) {
        ++away;
        wrong += !std::isinf(at_most);
        continue;
      }
      const SurfacePoint match = facing.point(texel);
      wrong += facing.kind[texel] != MatchKind::facing ||
               !allowed(normal_of(o2, match.face), normal, angle, -1e-9);
      const double found = norm(point_of(o2, match) - q);
      wrong += !(found >= at_least - error && found <= at_most + error);
    }
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(texels, 8000U);
  EXPECT_GT(away, 100U);
}

TEST(Match, RaysEndAtTheHitsOfBruteForceAtEveryTexelOf40Pairs) {
  constexpr double kCage = 0.6, kError = 1e-6;
  std::size_t texels = 0, wrong = 0, hits = 0, undecided = 0;
  for (const auto& [o1, o2] : pairs_to_match()) {
    const Surface surface(o1, {.resolution = 24});
    const double angle = texels % 2 == 0 ? 90 : 75;
    const TexelMatches matches =
        match_texels(surface, Sites(o2), {.method = MatchMethod::ray, .facing = angle, .cage = kCage});
    const std::vector<Vec3> normals = normals_of_vertices(o1);
    for (const std::uint32_t texel : test::owned_texels(surface)) {
      ++texels;
      const Vec3 q = surface.texel_point(texel), u = normal_at_texel(surface, normals, texel);
      const Vec3 normal = normal_of(o1, surface.map_faces()[texel]);
      // Of faces enlarged, and made smaller, by more than the rounding of the normals.
      const auto least = [&](double margin) {
        double found = kInfinity;
        for (std::uint32_t f = 0; f < o2.triangles.size(); ++f)
          if (allowed(normal_of(o2, f), normal, angle, margin))
            if (const auto t = on_line(o2, f, q, u, margin); t && std::abs(*t) <= kCage - margin)
              found = std::min(found, std::abs(*t));
        return found;
      };
      const double at_most = least(1e-6), at_least = least(-1e-6);
      undecided += at_most != at_least;
      if (matches.kind[texel] != MatchKind::ray) {
        wrong += !std::isinf(at_most);
        continue;
      }
      ++hits;
      const SurfacePoint match = matches.point(texel);
      wrong += !allowed(normal_of(o2, match.face), normal, angle, -1e-9);
      const Vec3 way = point_of(o2, match) - q;
      wrong += !(norm(cross(way, u)) <= kError);
      wrong += !(norm(way) >= at_least - kError && norm(way) <= at_most + kError);
    }
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(hits, 2000U);
  EXPECT_LT(hits, texels);
  EXPECT_LT(undecided, texels / 500);
}

// Hits are those of rational arithmetic.
TEST(Match, NoHitIsLostBesideFacesThatFaceAway) {
  // Along the normals of a square, all lines through the diagonal and the vertices of a grid below it, whose
  // every other face is flipped.
  const Mesh o1 = square(1, 0.25);
  Mesh o2 = terrain(8, [](double, double) { return 0.0; });
  for (Vec3& p : o2.positions) p = {p[0] / 20 - 0.5, p[1] / 20 - 0.5, 0};
  const std::size_t faces = o2.triangles.size();
  for (std::size_t f = 0; f < faces; ++f) {
    // Below each face a second one that faces the other way, nearer to the square.
    Triangle turned = o2.triangles[f];
    for (std::uint32_t& v : turned) {
      o2.positions.push_back({o2.positions[v][0], o2.positions[v][1], 0.125});
      v = static_cast<std::uint32_t>(o2.positions.size() - 1);
    }
    std::swap(turned[0], turned[1]);
    o2.triangles.push_back(turned);
  }
  const Surface surface(o1, {.kind = AtlasKind::charts, .resolution = 48});
  const TexelMatches matches = match_texels(surface, Sites(o2), {.method = MatchMethod::ray});
  ASSERT_GT(surface.owned_texels(), 500U);
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    ASSERT_EQ(matches.kind[texel], MatchKind::ray);
    const Vec3 q = surface.texel_point(texel);
    double least = kInfinity;
    for (std::uint32_t f = 0; f < faces; ++f) {
      const auto& [a, b, c] = o2.triangles[f];
      // Rational arithmetic is slow: only of faces that may be below the texel.
      if (norm(o2.positions[a] - Vec3{q[0], q[1], 0}) > 0.2) continue;
      if (const auto hit =
              oracle::ray_in_triangle(q, {0, 0, -1}, {o2.positions[a], o2.positions[b], o2.positions[c]}))
        least = std::min(least, hit->first);
    }
    ASSERT_NEAR(least, 0.25, 1e-9);
    ASSERT_LT(matches.face[texel], faces);
    ASSERT_NEAR(point_of(o2, matches.point(texel))[2], 0, 1e-9);
  }
}

/// A curved sheet of this thickness over [−1, 1]², of n² squares a skin: skins first the upper, then the
/// lower one; then the rim.
struct Sheet {
  Mesh mesh;
  std::size_t faces_of_skin;

  Sheet(int n, double thickness) : faces_of_skin(static_cast<std::size_t>(2 * n * n)) {
    for (const int skin : {0, 1})
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
          const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
          const Vec3 normal = normalized({0.5 * x, 0.5 * y, 1});
          mesh.positions.push_back(Vec3{x, y, -0.25 * (x * x + y * y)} +
                                   (skin == 0 ? 0.5 : -0.5) * thickness * normal);
        }
    const auto at = [n](int skin, int i, int j) {
      return static_cast<std::uint32_t>((skin * (n + 1) + j) * (n + 1) + i);
    };
    for (const int skin : {0, 1})
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          add(at(skin, i, j), at(skin, i + 1, j), at(skin, i + 1, j + 1), at(skin, i, j + 1), skin == 1);
    for (int i = 0; i < n; ++i) {
      add(at(1, i, 0), at(1, i + 1, 0), at(0, i + 1, 0), at(0, i, 0), false);
      add(at(0, i, n), at(0, i + 1, n), at(1, i + 1, n), at(1, i, n), false);
      add(at(0, 0, i), at(0, 0, i + 1), at(1, 0, i + 1), at(1, 0, i), false);
      add(at(1, n, i), at(1, n, i + 1), at(0, n, i + 1), at(0, n, i), false);
    }
  }

  /// 0: the upper skin, 1: the lower one, 2: the rim.
  [[nodiscard]] std::size_t part(std::uint32_t face) const {
    return std::min<std::size_t>(2, face / faces_of_skin);
  }

 private:
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, bool turned) {
    if (turned) std::swap(b, d);
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
};

/// The share of the texels of skins whose colour is that of the other skin.
double wrong_sides(const Surface& surface, const Sheet& low, const Sites& sites, const Sheet& high,
                   MatchMethod method) {
  std::vector<float> colors;
  for (std::uint32_t f = 0; f < high.mesh.triangles.size(); ++f)
    colors.push_back(static_cast<float>(high.part(f)));
  const TexelMatches matches = match_texels(surface, sites, {.method = method});
  const auto read =
      transfer(surface, sites, matches, {.values = colors, .domain = AttributeDomain::face}, {.fill = false});
  std::size_t wrong = 0, all = 0;
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    const std::size_t part = low.part(surface.map_faces()[texel]);
    if (part == 2) continue;
    ++all;
    wrong += !(read[texel] == static_cast<float>(part) || read[texel] == 2);
  }
  return static_cast<double>(wrong) / static_cast<double>(all);
}

// Sheets of 200 mm, 0.1 to 4 mm thick, with one colour above and another below, onto versions of few
// triangles.
TEST(Match, ThinSheetsAreReadOnTheRightSide) {
  for (const double millimetres : {0.1, 0.3, 1.0, 2.0, 4.0}) {
    SCOPED_TRACE(millimetres);
    const Sheet high(48, millimetres / 100), low(4, millimetres / 100);
    const Surface surface(low.mesh, {.resolution = 128});
    const Sites sites(high.mesh);
    ASSERT_TRUE(sites.closed());
    EXPECT_EQ(wrong_sides(surface, low, sites, high, MatchMethod::facing), 0);
    EXPECT_EQ(wrong_sides(surface, low, sites, high, MatchMethod::ray), 0);
    const double unconstrained = wrong_sides(surface, low, sites, high, MatchMethod::closest);
    RecordProperty("wrong_sides_of_closest_points_" + std::to_string(millimetres),
                   std::to_string(unconstrained));
    EXPECT_GT(unconstrained, millimetres <= 1 ? 0.1 : 0);
  }
}

TEST(Match, StatesWhyATexelHasNoPoint) {
  const Sites sites(square(1, 0));
  const Surface near(square(1, 0.25), {.resolution = 16}),
      turned(flipped(square(1, 0.25)), {.resolution = 16});
  const std::size_t texels = near.owned_texels();
  for (const MatchMethod method : {MatchMethod::facing, MatchMethod::ray}) {
    const auto of = [&](const Surface& surface, double max_distance, double cage) {
      return match_texels(surface, sites, {.method = method, .cage = cage, .max_distance = max_distance});
    };
    EXPECT_EQ(of(near, 0.1, kInfinity).count(MatchKind::too_far), texels);
    EXPECT_EQ(of(turned, kInfinity, kInfinity).count(MatchKind::facing_away), turned.owned_texels());
    EXPECT_EQ(
        of(near, kInfinity, kInfinity).count(method == MatchMethod::ray ? MatchKind::ray : MatchKind::facing),
        texels);
    // Beyond the cage there is still the closest point.
    EXPECT_EQ(of(near, kInfinity, 0.2).count(MatchKind::facing), texels);
  }
  EXPECT_EQ(match_texels(near, sites, {.method = MatchMethod::closest, .max_distance = 0.1})
                .count(MatchKind::too_far),
            texels);
}

TEST(Match, FollowsTheNormalsThatAreGiven) {
  const Surface surface(square(1, 0.25), {.resolution = 16});
  const Sites sites(square(4, 0));
  MeshAttribute slanted = smooth_normals(surface.mesh());
  for (std::size_t i = 0; i < slanted.values.size(); i += 3) slanted.values[i] = slanted.values[i + 2];
  const TexelMatches matches =
      match_texels(surface, sites, {.method = MatchMethod::ray, .normals = &slanted});
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    const Vec3 way = point_of(sites.mesh(), matches.point(texel)) - surface.texel_point(texel);
    ASSERT_NEAR(way[0], -0.25, 1e-6);
    ASSERT_NEAR(way[1], 0, 1e-6);
    ASSERT_NEAR(way[2], -0.25, 1e-6);
  }
}

TEST(Match, TransfersAsTheMapDoes) {
  const Surface surface(torus(12, 8), {.resolution = 64});
  const Sites sites(placed(torus(14, 9), "rotate:1:2:3"));
  const DistanceMap map = compute_map(surface, sites, {.max_distance = 0.2});
  const TexelMatches matches = matches_of(surface, sites, map);
  std::vector<float> values;
  for (const Vec3& p : sites.mesh().positions)
    for (const double x : p) values.push_back(static_cast<float>(x));
  const auto by_map = transfer(surface, sites, map, {values, 3}),
             by_matches = transfer(surface, sites, matches, {values, 3});
  ASSERT_EQ(by_map.size(), by_matches.size());
  for (std::size_t i = 0; i < by_map.size(); ++i)
    ASSERT_TRUE(std::abs(by_map[i] - by_matches[i]) <= 1e-5 ||
                (std::isnan(by_map[i]) && std::isnan(by_matches[i])));
}

TEST(Match, RefusesWhatDoesNotFit) {
  const Surface surface(cube(), {.resolution = 16}), other(cube(), {.resolution = 32});
  const Sites sites(sphere(1)), fewer(tetrahedron());
  const auto refused = [&](const MatchOptions& options) {
    return error_of([&] { (void)match_texels(surface, sites, options); });
  };
  EXPECT_NE(refused({.facing = 0}), "");
  EXPECT_NE(refused({.facing = 181}), "");
  EXPECT_NE(refused({.max_distance = 0}), "");
  EXPECT_NE(refused({.method = MatchMethod::ray, .cage = -1}), "");
  MeshAttribute few = smooth_normals(tetrahedron());
  EXPECT_NE(refused({.method = MatchMethod::ray, .normals = &few}), "");
  const TexelMatches matches = match_texels(surface, sites, {});
  EXPECT_NE(error_of([&] { require_matches(other, sites, matches); }), "");
  EXPECT_NE(error_of([&] { require_matches(surface, fewer, matches); }), "");
  EXPECT_NE(error_of([&] { (void)matches_of(other, sites, compute_map(surface, sites)); }), "");
}

TEST(SmoothNormals, JoinFacesUpToTheCrease) {
  const MeshAttribute joined_up = smooth_normals(cube()), apart = smooth_normals(cube(), 40);
  EXPECT_EQ(joined_up.values.size(), 3U * 8U);
  EXPECT_EQ(apart.values.size(), 3U * 24U);
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_NEAR(std::abs(joined_up.values[3 * i]), 1 / std::sqrt(3.0), 1e-6);
  EXPECT_NE(error_of([] { (void)smooth_normals(cube(), -1); }), "");
}

}  // namespace
}  // namespace sdm::test
