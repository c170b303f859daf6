// Self-proximity against brute force over all faces, with a naive exclusion.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "geometry/triangle_pair.h"
#include "geometry/vec.h"
#include "support/map_checks.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/pair_oracle.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

// A strip of n × m squares along x, `length` long and 1 wide, bent about the y axis as `place` says.
template <class Place>
Mesh strip(std::uint32_t n, std::uint32_t m, double length, const Place& place) {
  Mesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= m; ++j) {
      const Vec2 xz = place(length * i / n);
      mesh.positions.push_back({xz[0], static_cast<double>(j) / m, xz[1]});
    }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      const std::uint32_t a = i * (m + 1) + j, b = a + m + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  return mesh;
}
Mesh flat(std::uint32_t n = 20, std::uint32_t m = 4) {
  return strip(n, m, 4, [](double s) { return Vec2{s, 0}; });
}
// Two parallel sheets, `gap` apart, that a half-circle joins.
Mesh folded(double gap, std::uint32_t n = 20, std::uint32_t m = 4) {
  return strip(n, m, 4, [gap](double s) {
    const double radius = gap / 2, bend = std::numbers::pi * radius, sheet = (4 - bend) / 2;
    if (s <= sheet) return Vec2{s, 0};
    if (s >= sheet + bend) return Vec2{4 - s, gap};
    const double angle = (s - sheet) / radius;
    return Vec2{sheet + radius * std::sin(angle), radius * (1 - std::cos(angle))};
  });
}

Corners corners(const Mesh& mesh, std::size_t face) {
  const Triangle& t = mesh.triangles[face];
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

using Relation = std::vector<std::vector<bool>>;

Relation touching(const Mesh& mesh) {
  const std::size_t n = mesh.triangles.size();
  Relation touch(n, std::vector<bool>(n));
  for (std::size_t f = 0; f < n; ++f)
    for (std::size_t g = 0; g < n; ++g)
      touch[f][g] =
          std::ranges::find_first_of(mesh.triangles[f], mesh.triangles[g]) != mesh.triangles[f].end();
  return touch;
}

bool within(double length, const Corners& a, const Corners& b) {
  return squared_box_distance(a, b) < length * length && oracle::distance(a, b) < length;
}

// All pairs of faces, by the definition of the rule.
Relation excluded(const Mesh& rest, const ExclusionRule& rule) {
  const Relation touch = touching(rest);
  const std::size_t n = touch.size();
  Relation reach(n, std::vector<bool>(n));
  for (std::size_t f = 0; f < n; ++f) {
    reach[f][f] = true;
    std::vector<std::size_t> ring{f};
    for (std::uint32_t k = 0; !ring.empty() && (rule.geodesic || k < rule.rings); ++k) {
      std::vector<std::size_t> next;
      for (const std::size_t from : ring)
        for (std::size_t g = 0; g < n; ++g) {
          if (reach[f][g] || !touch[from][g]) continue;
          if (rule.geodesic && !touch[f][g] && !within(*rule.geodesic, corners(rest, f), corners(rest, g)))
            continue;
          reach[f][g] = true;
          next.push_back(g);
        }
      ring = next;
    }
  }
  if (rule.geodesic)
    for (std::size_t f = 0; f < n; ++f)
      for (std::size_t g = 0; g < f; ++g) reach[f][g] = reach[g][f] = reach[f][g] && reach[g][f];
  return reach;
}

void expect_exclusion(const Exclusion& exclusion, const Relation& expected) {
  ASSERT_EQ(exclusion.faces(), expected.size());
  for (std::uint32_t f = 0; f < expected.size(); ++f) {
    std::vector<std::uint32_t> row;
    for (std::uint32_t g = 0; g < expected.size(); ++g)
      if (expected[f][g]) row.push_back(g);
    std::vector<std::uint32_t> found;
    for (const std::uint32_t patch : exclusion.excluded_by(exclusion.patch_of(f)))
      found.insert(found.end(), exclusion.faces_of(patch).begin(), exclusion.faces_of(patch).end());
    std::ranges::sort(found);
    ASSERT_EQ(found, row) << "face " << f;
  }
}

void expect_self_map(const Surface& surface, const Sites& sites, const DistanceMap& map,
                     const Relation& excluded, double max_distance = kInfinity) {
  const Mesh& mesh = sites.mesh();
  std::size_t none = 0;
  const double tolerance = 1e-6 * diagonal(bounds(mesh));
  for (std::uint32_t texel = 0; texel < map.distance.size(); ++texel) {
    const std::uint32_t face = surface.map_faces()[texel];
    const float d = map.distance[texel];
    if (face == kNone) {
      ASSERT_TRUE(std::isnan(d) && std::isnan(map.vector[texel][0]));
      continue;
    }
    const Vec3 p = surface.texel_point(texel);
    double expected = kInfinity;
    for (std::uint32_t g = 0; g < mesh.triangles.size(); ++g)
      if (const auto [a, b, c] = corners(mesh, g); !excluded[face][g])
        expected = std::min(expected, oracle::distance(p, a, b, c));
    if (expected == kInfinity || expected > max_distance) {
      ++none;
      ASSERT_EQ(d, std::numeric_limits<float>::infinity());
      ASSERT_EQ(map.vector[texel], (Vec3f{0, 0, 0}));
      ASSERT_EQ(map.site[texel], kNone);
      ASSERT_EQ(map.site_type[texel], SiteType::none);
      continue;
    }
    ASSERT_NEAR(d, expected, tolerance) << "texel " << texel;
    const Vec3f& v = map.vector[texel];
    ASSERT_NEAR(std::hypot(v[0], v[1], v[2]), d, tolerance);
    const Vec3 q = p + Vec3{v[0], v[1], v[2]};
    ASSERT_LE(distance_to_site(sites, map.site_type[texel], map.site[texel], q), tolerance);
  }
  EXPECT_EQ(map.beyond_max_distance, none);
}

struct Case {
  std::string name;
  Mesh mesh;
  ExclusionRule rule;
};

std::vector<Case> cases() {
  std::mt19937 random(5);
  return {{"folded, 1 ring", folded(0.2), {}},
          {"folded, 3 rings", folded(0.2), {.rings = 3}},
          {"folded, geodesic", folded(0.2), {.geodesic = 0.45}},
          {"flat, geodesic", flat(), {.geodesic = 0.45}},
          {"torus, 2 rings", torus(12, 8), {.rings = 2}},
          {"torus, geodesic", torus(12, 8), {.geodesic = 1.1}},
          {"octagonal", load("eight.off"), {.rings = 2}},
          {"soup", soup(60, random), {}},
          {"soup, geodesic", soup(60, random), {.geodesic = 0.3}},
          {"finely folded, geodesic", folded(0.2, 80, 12), {.geodesic = 0.9}},
          {"octagonal, geodesic", load("eight.off", "fit"), {.geodesic = 0.3}},
          {"two sheets", joined(flat(10, 3), placed(flat(10, 3), "translate:0:0:0.1")), {.geodesic = 0.7}}};
}

TEST(Self, ExclusionMatchesItsDefinition) {
  for (const Case& c : cases()) {
    if (c.mesh.triangles.size() > 500) continue;
    SCOPED_TRACE(c.name);
    expect_exclusion(Exclusion(c.mesh, {.rule = c.rule}), excluded(c.mesh, c.rule));
  }
}

// A bumpy sphere of 8 · 4^k faces, with a diameter of about 2.
Mesh bumpy(int k) {
  Mesh mesh = sphere(k);
  for (Vec3& p : mesh.positions) p = (1 + 0.1 * std::sin(5 * p[0]) * std::sin(4 * p[1])) * p;
  return mesh;
}

// The largest distance of two points of a patch.
double width(const Mesh& mesh, const Exclusion& exclusion, std::uint32_t patch) {
  double squared = 0;
  for (const std::uint32_t f : exclusion.faces_of(patch))
    for (const std::uint32_t g : exclusion.faces_of(patch))
      for (const Vec3& p : corners(mesh, f))
        for (const Vec3& q : corners(mesh, g)) squared = std::max(squared, squared_norm(q - p));
  return std::sqrt(squared);
}

// A closed tube along z, of n segments each as long as the tube.
Mesh tube(std::uint32_t n, double radius, double height) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    for (const double z : {0.0, height})
      mesh.positions.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
  }
  return mesh;
}

TEST(Self, PatchesAreSmall) {
  const Mesh mesh = bumpy(4);
  const double length = 0.6;
  const Exclusion exclusion(mesh, {.rule = {.geodesic = length}});
  EXPECT_LT(exclusion.patches(), mesh.triangles.size() / 3);
  std::vector<std::uint32_t> times(mesh.triangles.size());
  for (std::uint32_t patch = 0; patch < exclusion.patches(); ++patch) {
    const auto faces = exclusion.faces_of(patch);
    ASSERT_FALSE(faces.empty());
    for (const std::uint32_t f : faces) {
      ASSERT_EQ(exclusion.patch_of(f), patch);
      ++times[f];
    }
    ASSERT_LE(width(mesh, exclusion, patch), length / 2);
  }
  for (const std::uint32_t n : times) ASSERT_EQ(n, 1u);
}

// Regression: thin faces were grouped by their centroids, and whole patches measured by the spheres around
// them: everything was excluded.
TEST(Self, LongFacesDoNotExcludeTheOppositeWall) {
  const double length = 5;
  const Mesh mesh = tube(400, 30, 100);
  const Exclusion exclusion(mesh, {.rule = {.geodesic = length}});
  EXPECT_EQ(exclusion.patches(), mesh.triangles.size());
  for (const float d : distances_at_vertices(mesh, Sites(mesh), SelfOptions{.exclusion = exclusion})) {
    ASSERT_GE(d, 0.9 * length);
    ASSERT_LE(d, 2 * length);
  }
  // Long faces beside small ones.
  const Mesh both = joined(mesh, placed(bumpy(4), "scale:5"));
  const Exclusion of_both(both, {.rule = {.geodesic = length}});
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
    EXPECT_FALSE(of_both.excludes(
        f, static_cast<std::uint32_t>((f + mesh.triangles.size() / 2) % mesh.triangles.size())));
}

// Excluded patches by the definition, from the patches themselves.
Relation excluded_patches(const Mesh& mesh, const Exclusion& exclusion, double length) {
  struct Ball {
    Vec3 centre;
    double radius = 0;
  };
  const std::size_t n = exclusion.patches();
  std::vector<Ball> balls(n);
  std::vector<std::set<std::uint32_t>> at_vertex(mesh.positions.size());
  for (std::uint32_t p = 0; p < n; ++p) {
    Box box;
    for (const std::uint32_t f : exclusion.faces_of(p))
      for (const Vec3& c : corners(mesh, f)) extend(box, c);
    balls[p].centre = 0.5 * (box.lower + box.upper);
    for (const std::uint32_t f : exclusion.faces_of(p)) {
      for (const Vec3& c : corners(mesh, f))
        balls[p].radius = std::max(balls[p].radius, norm(c - balls[p].centre));
      for (const std::uint32_t v : mesh.triangles[f]) at_vertex[v].insert(p);
    }
  }
  const auto near = [&](std::uint32_t p, std::uint32_t q) {
    const bool single_p = exclusion.faces_of(p).size() == 1, single_q = exclusion.faces_of(q).size() == 1;
    const auto face = [&](std::uint32_t patch) { return corners(mesh, exclusion.faces_of(patch)[0]); };
    const auto to_ball = [&](const Corners& t, const Ball& ball) {
      return oracle::distance(ball.centre, t[0], t[1], t[2]) < length + ball.radius;
    };
    if (single_p && single_q) return within(length, face(p), face(q));
    if (single_p) return to_ball(face(p), balls[q]);
    if (single_q) return to_ball(face(q), balls[p]);
    return norm(balls[q].centre - balls[p].centre) < length + balls[p].radius + balls[q].radius;
  };
  Relation reach(n, std::vector<bool>(n));
  for (std::uint32_t p = 0; p < n; ++p) {
    reach[p][p] = true;
    std::vector<std::uint32_t> open{p};
    while (!open.empty()) {
      const std::uint32_t from = open.back();
      open.pop_back();
      for (const std::uint32_t f : exclusion.faces_of(from))
        for (const std::uint32_t v : mesh.triangles[f])
          for (const std::uint32_t q : at_vertex[v])
            if (!reach[p][q] && near(p, q)) {
              reach[p][q] = true;
              open.push_back(q);
            }
    }
  }
  for (std::size_t p = 0; p < n; ++p)
    for (std::size_t q = 0; q < p; ++q) reach[p][q] = reach[q][p] = reach[p][q] && reach[q][p];
  return reach;
}

TEST(Self, ExclusionOfPatchesMatchesItsDefinition) {
  struct Fine {
    Mesh mesh;
    double length;
  };
  for (const auto& [mesh, length] : {Fine{bumpy(3), 1.0}, Fine{bumpy(4), 0.8}, Fine{folded(0.2, 80, 12), 0.9},
                                     Fine{load("eight.off", "fit"), 0.3}}) {
    const Exclusion exclusion(mesh, {.rule = {.geodesic = length}});
    EXPECT_LT(exclusion.patches(), 2 * mesh.triangles.size() / 3);
    const Relation expected = excluded_patches(mesh, exclusion, length);
    for (std::uint32_t p = 0; p < exclusion.patches(); ++p) {
      std::vector<std::uint32_t> row;
      for (std::uint32_t q = 0; q < exclusion.patches(); ++q)
        if (expected[p][q]) row.push_back(q);
      ASSERT_TRUE(std::ranges::equal(exclusion.excluded_by(p), row)) << "patch " << p;
    }
  }
}

// A pair of patches is excluded only if both are within reach of each other, and symmetrically.
TEST(Self, ExclusionOfPatchesReachesALittleFartherThanItsLength) {
  const Mesh mesh = bumpy(3);
  for (const double length : {0.2, 0.6, 1.0}) {
    const Exclusion exclusion(mesh, {.rule = {.geodesic = length}});
    for (std::uint32_t p = 0; p < exclusion.patches(); ++p)
      for (const std::uint32_t q : exclusion.excluded_by(p)) {
        ASSERT_TRUE(std::ranges::binary_search(exclusion.excluded_by(q), p));
        double least = kInfinity;
        for (const std::uint32_t f : exclusion.faces_of(p))
          for (const std::uint32_t g : exclusion.faces_of(q))
            for (const Vec3& a : corners(mesh, f))
              for (const Vec3& b : corners(mesh, g)) least = std::min(least, norm(b - a));
        ASSERT_LT(least, 2 * length);
      }
  }
}

// The number of excluded patches per face is bounded for every length.
TEST(Self, ExclusionTakesMemoryInProportionToTheFaces) {
  const Mesh mesh = bumpy(5);
  for (const double length : {0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6}) {
    const Exclusion exclusion(mesh, {.rule = {.geodesic = length}});
    std::size_t entries = 0;
    for (std::uint32_t p = 0; p < exclusion.patches(); ++p) entries += exclusion.excluded_by(p).size();
    EXPECT_LT(entries, 200 * mesh.triangles.size()) << "length " << length;
  }
}

// Paths along edges are paths along the surface.
void expect_everything_nearer_excluded(double length) {
  const Mesh mesh = load("eight.off", "fit");
  const Exclusion exclusion(mesh, {.rule = {.geodesic = length}});
  const std::size_t n = mesh.positions.size();
  const Sites sites(mesh);
  std::vector<std::set<std::uint32_t>> around(n);
  for (const auto& [a, b] : sites.edges()) {
    around[a].insert(b);
    around[b].insert(a);
  }
  std::vector<std::set<std::uint32_t>> faces(n);
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
    for (const std::uint32_t v : mesh.triangles[f]) faces[v].insert(f);
  std::size_t pairs = 0;
  for (std::uint32_t start = 0; start < n; start += 7) {
    std::vector<double> way(n, kInfinity);  // Bellman and Ford
    way[start] = 0;
    for (bool better = true; better;) {
      better = false;
      for (std::uint32_t v = 0; v < n; ++v)
        for (const std::uint32_t w : around[v])
          if (const double d = way[v] + norm(mesh.positions[w] - mesh.positions[v]); d < way[w]) {
            way[w] = d;
            better = true;
          }
    }
    for (std::uint32_t v = 0; v < n; ++v) {
      if (!(way[v] < length)) continue;
      for (const std::uint32_t f : faces[start])
        for (const std::uint32_t g : faces[v]) {
          ASSERT_TRUE(exclusion.excludes(f, g));
          ++pairs;
        }
    }
  }
  EXPECT_GT(pairs, 1000u);
}

TEST(Self, ExcludesEverythingNearerAlongTheSurface) {
  for (const double length : {0.15, 0.5}) {
    SCOPED_TRACE(length);
    expect_everything_nearer_excluded(length);
  }
}

TEST(Self, MapAgreesWithBruteForceAtEveryTexel) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Surface surface(c.mesh, {.resolution = 96});
    const Sites sites(c.mesh);
    const Exclusion exclusion(c.mesh, {.rule = c.rule});
    Relation all(c.mesh.triangles.size(), std::vector<bool>(c.mesh.triangles.size()));
    for (std::uint32_t f = 0; f < all.size(); ++f)
      for (std::uint32_t g = 0; g < all.size(); ++g) all[f][g] = exclusion.excludes(f, g);
    const DistanceMap map = compute_map(surface, sites, SelfOptions{.exclusion = exclusion});
    expect_self_map(surface, sites, map, all);
    const double limit = statistics(surface, map).p50;
    expect_self_map(surface, sites,
                    compute_map(surface, sites, SelfOptions{.exclusion = exclusion, .max_distance = limit}),
                    all, limit);
  }
}

TEST(Self, DistanceAcrossAFoldIsItsGap) {
  const Mesh mesh = folded(0.2, 60, 8);
  const Surface surface(mesh, {.resolution = 128});
  const Sites sites(mesh);
  // The exclusion is that of the flat rest shape: the path around the bend counts.
  const DistanceMap map = compute_map(
      surface, sites, SelfOptions{.exclusion = Exclusion(flat(60, 8), {.rule = {.geodesic = 0.6}})});
  for (const std::uint32_t texel : surface.sample_texels()) {
    if (surface.texel_point(texel)[0] > 1) continue;
    ASSERT_NEAR(map.distance[texel], 0.2, 1e-6);
  }
}

// Distances to other points jump between faces, whose exclusions differ: samples prove nothing.
TEST(Self, SamplesDoNotProveATolerance) {
  const Mesh mesh = folded(0.2, 60, 8);
  const Surface surface(mesh, {.resolution = 128});
  const Sites sites(mesh);
  const Exclusion exclusion(flat(60, 8), {.rule = {.geodesic = 0.6}});
  const DistanceMap map = compute_map(surface, sites, SelfOptions{.exclusion = exclusion});
  EXPECT_EQ(map.measured.kind, DistanceKind::self);
  const std::vector<float> at_vertices =
      distances_at_vertices(sites.mesh(), sites, SelfOptions{.exclusion = exclusion});
  const double accuracy = engine_accuracy(engines().front(), mesh, mesh);
  const double bound = covering_radius(surface);
  const Tolerance tolerance(10);
  const ToleranceVerdict verdict = check_tolerance(surface, map, at_vertices, bound, accuracy, tolerance);
  EXPECT_EQ(verdict.verdict, Verdict::pass) << "of all samples";
  EXPECT_FALSE(verdict.certified);
  const CertifiedVerdict judged = certify_tolerance(surface, sites, map, at_vertices, tolerance,
                                                    {.error_bound = bound, .accuracy = accuracy});
  EXPECT_FALSE(judged.certified);
  EXPECT_FALSE(judged.proof) << "the distance to all of the mesh is 0";
  EXPECT_FALSE(
      evidence_of(surface, map, std::vector<float>(at_vertices.size(), INFINITY), bound, accuracy).unmatched);
}

TEST(Self, NoDistanceWhereAllIsExcluded) {
  const Mesh mesh = tetrahedron();
  const Surface surface(mesh, {.resolution = 32});
  const Sites sites(mesh);
  const Exclusion exclusion(mesh);
  const DistanceMap map = compute_map(surface, sites, SelfOptions{.exclusion = exclusion});
  expect_self_map(surface, sites, map, Relation(4, std::vector<bool>(4, true)));
  EXPECT_EQ(map.beyond_max_distance, surface.sample_texels().size());
  EXPECT_EQ(statistics(surface, map).texels, 0u);
  EXPECT_TRUE(std::isnan(statistics(surface, map).max));
  EXPECT_EQ(area_fraction_beyond(surface, map, 1), 1);
  for (const float d : distances_at_vertices(sites.mesh(), sites, SelfOptions{.exclusion = exclusion}))
    EXPECT_EQ(d, kInfinity);
  SelfProximityQuery query(mesh);
  EXPECT_FALSE(query.separation());
  EXPECT_TRUE(query.contacts(10).empty());
}

// All faces are one patch, and so is the whole tree.
TEST(Self, NoDistanceWithinALengthBeyondTheMesh) {
  const Mesh mesh = folded(0.2);
  const ExclusionRule rule{.geodesic = 100};
  const Exclusion exclusion(mesh, {.rule = rule});
  EXPECT_EQ(exclusion.patches(), 1u);
  const Surface surface(mesh, {.resolution = 64});
  const Sites sites(mesh);
  EXPECT_EQ(compute_map(surface, sites, SelfOptions{.exclusion = exclusion}).beyond_max_distance,
            surface.sample_texels().size());
  for (const float d : distances_at_vertices(sites.mesh(), sites, SelfOptions{.exclusion = exclusion}))
    ASSERT_EQ(d, kInfinity);
  EXPECT_FALSE(SelfProximityQuery(mesh, {.exclusion = rule}).separation());

  // Another sheet, which is not connected to the first, is not excluded.
  const Mesh sheets = joined(flat(10, 3), placed(flat(10, 3), "translate:0:0:0.1"));
  const Exclusion of_sheets(sheets, {.rule = rule});
  EXPECT_EQ(of_sheets.patches(), 2u);
  for (const float d : distances_at_vertices(sheets, Sites(sheets), SelfOptions{.exclusion = of_sheets}))
    ASSERT_NEAR(d, 0.1, 1e-6);
}

TEST(Self, VerticesHaveTheMinimumOfTheirFaces) {
  Mesh mesh = folded(0.2);
  mesh.positions.push_back({9, 9, 9});  // of no face
  const Sites sites(mesh);
  const ExclusionRule rule{.rings = 2};
  const std::vector<float> found =
      distances_at_vertices(sites.mesh(), sites, SelfOptions{.exclusion = Exclusion(mesh, {.rule = rule})});
  const Relation out = excluded(mesh, rule);
  std::vector<double> expected(mesh.positions.size(), kInfinity);
  for (std::uint32_t f = 0; f < out.size(); ++f)
    for (const std::uint32_t v : mesh.triangles[f])
      for (std::uint32_t g = 0; g < out.size(); ++g)
        if (const auto [a, b, c] = corners(mesh, g); !out[f][g])
          expected[v] = std::min(expected[v], oracle::distance(mesh.positions[v], a, b, c));
  EXPECT_TRUE(std::isnan(found.back()));
  for (std::size_t v = 0; v + 1 < found.size(); ++v) ASSERT_NEAR(found[v], expected[v], 1e-6) << v;
}

TEST(Self, IgnoresDegenerateAndDuplicateFaces) {
  const Mesh clean = flat();
  Mesh flawed = clean;
  flawed.triangles.push_back(clean.triangles[5]);
  flawed.triangles.push_back({40, 41, 41});
  flawed.triangles.push_back({100, 0, 0});  // 100 is a corner of one face only
  const Sites sites(flawed);
  const Exclusion exclusion(flawed);
  const std::vector<float> found =
      distances_at_vertices(sites.mesh(), sites, SelfOptions{.exclusion = exclusion});
  EXPECT_EQ(found, distances_at_vertices(clean, Sites(clean), SelfOptions{.exclusion = Exclusion(clean)}));
  SelfProximityQuery query(clean), other(flawed);
  EXPECT_EQ(query.separation()->value, other.separation()->value);
  const Surface with_flaws(flawed, {.resolution = 64});
  const DistanceMap map = compute_map(with_flaws, sites, SelfOptions{.exclusion = exclusion});
  for (const std::uint32_t texel : with_flaws.sample_texels())
    ASSERT_TRUE(std::isfinite(map.distance[texel]));
}

// The pairs that count, by CGAL.
struct Pairs {
  std::vector<double> nearest;  // of each face
  double least = kInfinity;

  Pairs(const Mesh& mesh, const Relation& out) : nearest(out.size(), kInfinity) {
    for (std::size_t f = 0; f < out.size(); ++f)
      for (std::size_t g = 0; g < f; ++g) {
        const Corners a = corners(mesh, f), b = corners(mesh, g);
        const double most = std::max(nearest[f], nearest[g]);
        if (out[f][g] || squared_box_distance(a, b) > most * most) continue;
        const double d = oracle::distance(a, b);
        nearest[f] = std::min(nearest[f], d);
        nearest[g] = std::min(nearest[g], d);
        least = std::min(least, d);
      }
  }
};

void expect_on(const Mesh& mesh, const Vec3& p) {
  EXPECT_LE(oracle::brute_force(mesh, p), 1e-9 * diagonal(bounds(mesh)));
}

void expect_as_pairs(SelfProximityQuery& query, const Relation& out) {
  const Mesh& mesh = query.sites().mesh();
  const Pairs pairs(mesh, out);
  const double tolerance = 1e-9 * diagonal(bounds(mesh));
  const std::optional<BoundedLength> separation = query.separation();
  ASSERT_TRUE(separation);
  EXPECT_EQ(separation->certainty, Certainty::exact);
  EXPECT_NEAR(separation->value, pairs.least, tolerance);
  ASSERT_TRUE(separation->witness);
  const auto& [p, q] = *separation->witness;
  EXPECT_NEAR(norm(q - p), separation->value, tolerance);
  expect_on(mesh, p);
  expect_on(mesh, q);

  const double margin = 1.3 * pairs.least + 0.01 * diagonal(bounds(mesh));
  const auto contacts = query.contacts(margin);
  const std::size_t near = std::ranges::count_if(pairs.nearest, [&](double d) { return d <= margin; });
  EXPECT_LE(contacts.size(), near);
  EXPECT_GE(2 * contacts.size(), near);
  std::vector<double> depths;
  std::uint32_t patch = 0;
  for (const Contact& c : contacts) {
    depths.push_back(-c.depth);
    EXPECT_LE(-c.depth, margin);
    EXPECT_NEAR(norm(c.point2 - c.point1), -c.depth, tolerance);
    EXPECT_NEAR(norm(c.normal), 1, 1e-9);
    EXPECT_LE(norm(c.point2 - c.point1 - c.depth * c.normal), tolerance);
    expect_on(mesh, c.point1);
    expect_on(mesh, c.point2);
    EXPECT_TRUE(c.patch == patch || c.patch == patch + 1);
    patch = c.patch;
  }
  // Each face's nearest is one of them.
  std::ranges::sort(depths);
  for (const double d : pairs.nearest) {
    if (d > margin) continue;
    const auto at = std::ranges::lower_bound(depths, d - tolerance);
    ASSERT_TRUE(at != depths.end() && *at <= d + tolerance) << d;
  }
}

TEST(Self, SeparationAndContactsAgreeWithAllPairs) {
  for (const Case& c : cases()) {
    if (c.mesh.triangles.size() > 500) continue;
    SCOPED_TRACE(c.name);
    SelfProximityQuery query(c.mesh, {.exclusion = c.rule});
    expect_as_pairs(query, excluded(c.mesh, c.rule));
  }
}

TEST(Self, FollowsADeformation) {
  const ExclusionRule rule{.geodesic = 0.45};
  const Relation out = excluded(flat(), rule);
  SelfProximityQuery query(flat(), {.exclusion = rule});
  Surface surface(flat(), {.resolution = 64});
  for (const double gap : {0.6, 0.3, 0.05}) {
    const Mesh now = folded(gap);
    query.refit(now.positions);
    surface.refit(now.positions);
    expect_self_map(surface, query.sites(),
                    compute_map(surface, query.sites(), SelfOptions{.exclusion = query.exclusion()}), out);
    expect_as_pairs(query, out);
    if (gap > 0.1) continue;  // the bend's faces are nearer than the sheets
    EXPECT_NEAR(query.separation()->value, gap, 1e-9);
    for (const Contact& c : query.contacts(1.01 * gap)) {
      EXPECT_EQ(c.patch, 0u);
      EXPECT_NEAR(std::abs(c.normal[2]), 1, 0.3);
    }
  }
}

TEST(Self, IntersectingSheetsHaveDistanceZero) {
  const Mesh mesh = joined(flat(10, 3), placed(flat(10, 3), "rotate:0:90:0,translate:2.03:0.1:2.05"));
  SelfProximityQuery query(mesh);
  ASSERT_TRUE(query.separation());
  EXPECT_EQ(query.separation()->value, 0);
  const auto contacts = query.contacts(0);
  ASSERT_FALSE(contacts.empty());
  for (const Contact& c : contacts) {
    EXPECT_EQ(c.patch, 0u);
    EXPECT_EQ(c.depth, 0);
    EXPECT_NEAR(norm(c.normal), 1, 1e-12);
  }
}

bool same_bits(const DistanceMap& a, const DistanceMap& b) {
  return std::memcmp(a.distance.data(), b.distance.data(), a.distance.size() * sizeof(float)) == 0 &&
         std::memcmp(a.vector.data(), b.vector.data(), a.vector.size() * sizeof(Vec3f)) == 0 &&
         a.site == b.site && a.site_type == b.site_type;
}

bool same(const std::optional<BoundedLength>& a, const std::optional<BoundedLength>& b) {
  return a && b && a->value == b->value && a->witness == b->witness;
}

void expect_same_for_any_thread_count(const ExclusionRule& rule) {
  const Mesh mesh = load("eight.off", "fit");
  const Surface surface(mesh, {.resolution = 256});
  SelfProximityQuery query(mesh, {.exclusion = rule});
  const std::vector<float> at_vertices =
      distances_at_vertices(query.sites().mesh(), query.sites(), SelfOptions{.exclusion = query.exclusion()});
  const double margin = 1.5 * query.separation()->value;
  const auto first = query.separation();
  const std::vector<Contact> contacts(query.contacts(margin).begin(), query.contacts(margin).end());
  const DistanceMap map = compute_map(surface, query.sites(), SelfOptions{.exclusion = query.exclusion()});
  for (const unsigned threads : {0u, 1u, 2u}) {
    const ThreadLimit limit(threads);
    query.refit(mesh.positions);
    EXPECT_TRUE(same(query.separation(), first));
    const auto again = query.contacts(margin);
    ASSERT_EQ(again.size(), contacts.size());
    for (std::size_t i = 0; i < again.size(); ++i) {
      EXPECT_EQ(again[i].point1, contacts[i].point1);
      EXPECT_EQ(again[i].point2, contacts[i].point2);
      EXPECT_EQ(again[i].patch, contacts[i].patch);
    }
    EXPECT_TRUE(
        same_bits(compute_map(surface, query.sites(), SelfOptions{.exclusion = query.exclusion()}), map));
    EXPECT_EQ(distances_at_vertices(query.sites().mesh(), query.sites(),
                                    SelfOptions{.exclusion = query.exclusion()}),
              at_vertices);
  }
}

TEST(Self, IsBitIdenticalForAnyThreadCount) {
  expect_same_for_any_thread_count({.rings = 3});
  expect_same_for_any_thread_count({.geodesic = 0.3});
}

TEST(Self, RigidMotionsChangeNothing) {
  const Mesh here = folded(0.2), there = placed(here, "rotate:20:50:70,translate:3:-2:5");
  const ExclusionRule rule{.rings = 3};
  const Sites sites(here), moved(there);
  Surface surface(here, {.resolution = 64});
  const DistanceMap before =
      compute_map(surface, sites, SelfOptions{.exclusion = Exclusion(here, {.rule = rule})});
  surface.refit(there.positions);
  const DistanceMap after =
      compute_map(surface, moved, SelfOptions{.exclusion = Exclusion(there, {.rule = rule})});
  for (const std::uint32_t texel : surface.sample_texels())
    ASSERT_NEAR(before.distance[texel], after.distance[texel], 1e-6);
  SelfProximityQuery a(here, {.exclusion = rule}), b(there, {.exclusion = rule});
  EXPECT_NEAR(a.separation()->value, b.separation()->value, 1e-12);
}

TEST(Self, MaximumDistanceHidesSeparations) {
  const double gap = SelfProximityQuery(folded(0.2), {.exclusion = {.rings = 3}}).separation()->value;
  EXPECT_TRUE(
      SelfProximityQuery(folded(0.2), {.exclusion = {.rings = 3}, .max_distance = 1.001 * gap}).separation());
  EXPECT_FALSE(
      SelfProximityQuery(folded(0.2), {.exclusion = {.rings = 3}, .max_distance = 0.999 * gap}).separation());
}

// All faces of a fan exclude the same ones, and those beside it others.
TEST(Self, FacesAroundAVertexOfManyExcludeEachOther) {
  constexpr std::uint32_t kFaces = 600;
  Mesh fan{{{0, 0, 0.1}}, {}, {}};
  for (std::uint32_t i = 0; i < kFaces; ++i) {
    const double angle = 2 * std::numbers::pi * i / kFaces;
    fan.positions.push_back({std::cos(angle), std::sin(angle), 0});
    fan.triangles.push_back({0, i + 1, (i + 1) % kFaces + 1});
  }
  fan.positions.push_back({2, 0, 0});
  fan.positions.push_back({2, 1, 0});
  fan.triangles.push_back({1, kFaces + 1, kFaces + 2});  // beside the first and the last face
  const Exclusion exclusion(fan);
  for (std::uint32_t f = 0; f <= kFaces; ++f)
    for (std::uint32_t g = 0; g <= kFaces; ++g) {
      const bool beside = f == 0 || f == kFaces - 1 || g == 0 || g == kFaces - 1 || f == g;
      ASSERT_EQ(exclusion.excludes(f, g), (f < kFaces && g < kFaces) || beside) << f << ' ' << g;
    }
  EXPECT_EQ(exclusion.excluded_by(1).data(), exclusion.excluded_by(300).data());
  EXPECT_EQ(exclusion.excluded_by(0).size(), kFaces + 1);
}

TEST(Self, RejectsOptionsOutOfRange) {
  const Mesh mesh = folded(0.2);
  EXPECT_THROW(Exclusion(mesh, {.rule = {.rings = 0}}), Error);
  for (const double bad : {0.0, -1.0, kInfinity, std::nan("")})
    EXPECT_THROW(Exclusion(mesh, {.rule = {.geodesic = bad}}), Error);
  EXPECT_THROW(SelfProximityQuery(mesh, {.max_distance = 0}), Error);
  SelfProximityQuery query(mesh);
  EXPECT_THROW((void)query.contacts(-1), Error);
  EXPECT_THROW((void)query.contacts(kInfinity), Error);
  const Surface surface(mesh, {.resolution = 64}), other(flat(3, 3), {.resolution = 64});
  EXPECT_THROW((void)compute_map(surface, query.sites(), SelfOptions{.exclusion = Exclusion(flat(3, 3))}),
               Error);
  EXPECT_THROW((void)compute_map(other, query.sites(), SelfOptions{.exclusion = query.exclusion()}), Error);
  EXPECT_THROW((void)compute_map(surface, query.sites(),
                                 SelfOptions{.exclusion = query.exclusion(), .max_distance = -1}),
               Error);
  std::vector<Vec3> wrong(mesh.positions.begin() + 1, mesh.positions.end());
  EXPECT_THROW(query.refit(wrong), Error);
  EXPECT_THROW(Exclusion(mesh, {.progress = [](std::string_view, double) { return false; }}), Cancelled);
}

}  // namespace
}  // namespace sdm::test
