// Simplifier: certificates against dense samples of an independent distance, limits, and what must survive.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/hausdorff.h>
#include <sdm/simplify.h>
#include <sdm/types.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <set>

#include "support/error_of.h"
#include "support/every_case.h"
#include "support/hausdorff_oracle.h"
#include "support/meshes.h"
#include "support/noise.h"
#include "support/oracle.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;

double box_diagonal(const Mesh& mesh) {
  return scene_diagonal(mesh, mesh);
}

/// The largest distance from samples of A, its vertices among them, to B.
double sampled(const Mesh& a, const Mesh& b) {
  std::mt19937 random(7);
  const std::size_t samples = subset(1000, 10'000);
  const oracle::CgalDistance distance(b);
  double largest = 0;
  for (const Vec3& p : random_surface_points(a, samples, random)) largest = std::max(largest, distance(p));
  for (std::size_t t = 0; t < a.triangles.size(); t += stride(7))
    for (const std::uint32_t v : a.triangles[t]) largest = std::max(largest, distance(a.positions[v]));
  return largest;
}

void expect_vertices_of(const Mesh& input, const Mesh& result) {
  const std::set<Vec3> known(input.positions.begin(), input.positions.end());
  for (const Vec3& p : result.positions) ASSERT_TRUE(known.contains(p));
  EXPECT_NO_THROW(validate(result));
}

/// Bounds contain what samples and an independent search find, and the witness is of both meshes.
void expect_certificate(const Mesh& input, const Simplified& simplified) {
  const BoundedLength& d = simplified.deviation;
  double coordinate = 0;
  for (const double x : bounds(input).upper) coordinate = std::max(coordinate, std::abs(x));
  for (const double x : bounds(input).lower) coordinate = std::max(coordinate, std::abs(x));
  const double rounding = 1e-9 * box_diagonal(input) + 4e-12 * coordinate;
  EXPECT_LE(d.lower, d.upper);
  EXPECT_LE(sampled(input, simplified.mesh), d.upper + rounding);
  EXPECT_LE(sampled(simplified.mesh, input), d.upper + rounding);
  const SymmetricHausdorff truth =
      symmetric_hausdorff(Sites(input), Sites(simplified.mesh), {.precision = 1e-3 * box_diagonal(input)});
  EXPECT_LE(d.lower, truth.larger.distance.upper);
  EXPECT_GE(d.upper, truth.larger.distance.lower);
  if (!d.witness) return;
  EXPECT_NEAR(norm((*d.witness)[0] - (*d.witness)[1]), d.lower, rounding);
  EXPECT_LE(oracle::CgalDistance(input)((*d.witness)[0]), rounding);
  EXPECT_LE(oracle::CgalDistance(simplified.mesh)((*d.witness)[1]), rounding);
}

struct Case {
  const char* name;
  Mesh mesh;
};

std::vector<Case> cases() {
  std::vector<Case> result;
  result.push_back({"sphere", sphere(5)});
  result.push_back({"torus, without seams", ring(80)});
  result.push_back({"torus, with seams", torus(90, 60)});
  result.push_back({"noisy sphere", with_noise(sphere(5), 0.2)});
  result.push_back({"open height field", height_field(70)});
  result.push_back({"Moebius band", band(300, true)});
  result.push_back({"two parts", joined(sphere(4), moved(ring(50), {4, 0, 0}))});
  result.push_back({"every face with vertices of its own", taken_apart(sphere(4), 0)});
  result.push_back({"duplicates, flipped and degenerate faces", with_defects(ring(40))});
  result.push_back({"far from the origin", moved(sphere(4), {1e6, -3e6, 2e6})});
  result.push_back({"fandisk", load("fandisk.off")});
  return result;
}

TEST(Simplifier, CertificatesHoldAndLimitsAreKept) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const double size = box_diagonal(c.mesh);
    Simplifier simplifier(c.mesh);
    for (const double share : {0.002, 0.02}) {
      for (const bool keep_vertices : {true, false}) {
        const Simplified s = simplifier.to_deviation(share * size, {.keep_vertices = keep_vertices});
        EXPECT_LE(s.deviation.upper, share * size);
        EXPECT_EQ(s.stopped, s.deviation.certainty == Certainty::exact) << "of the mesh itself";
        if (keep_vertices) expect_vertices_of(c.mesh, s.mesh);
        EXPECT_NO_THROW(validate(s.mesh));
        expect_certificate(c.mesh, s);
      }
    }
    const std::size_t count = c.mesh.triangles.size() / 5;
    const Simplified s = simplifier.to_triangles(count);
    EXPECT_TRUE(s.stopped || s.mesh.triangles.size() <= count) << s.mesh.triangles.size();
    EXPECT_GT(s.estimate, 0);
    expect_vertices_of(c.mesh, s.mesh);
    expect_certificate(c.mesh, s);
    EXPECT_LE(s.deviation.upper - s.deviation.lower, 0.02 * s.deviation.upper + 2e-6 * size);
  }
}

TEST(Simplifier, ReducesSmoothMeshesFar) {
  const Mesh mesh = sphere(5);
  Simplifier simplifier(mesh);
  const Simplified s = simplifier.to_deviation(0.01);
  // A sphere by n equilateral triangles deviates by about 7.3 / n, if vertices are on it.
  EXPECT_LT(s.mesh.triangles.size(), 2000);
  EXPECT_GT(s.deviation.upper, 0.006) << "much of the limit is used";
  EXPECT_TRUE(inspect(s.mesh).closed);
  EXPECT_TRUE(inspect(s.mesh).oriented);
}

/// The numbers of triangles for limits that grow by a factor, from shares of the diagonal.
std::vector<std::size_t> counts(const Mesh& mesh, double first, double last, bool keep_vertices) {
  std::vector<std::size_t> result;
  const double factor = std::exp(0.1 * static_cast<double>(subset(6, 2)));
  Simplifier simplifier(mesh);
  for (double limit = first * box_diagonal(mesh); limit <= last * box_diagonal(mesh); limit *= factor) {
    const Simplified s = simplifier.to_deviation(limit, {.keep_vertices = keep_vertices});
    EXPECT_LE(s.deviation.upper, limit);
    EXPECT_EQ(s.stopped, s.mesh.triangles.size() == mesh.triangles.size());
    result.push_back(s.mesh.triangles.size());
  }
  return result;
}

// Once, limits of 0.5 % and 1 % of some of these left the whole mesh, where smaller ones removed most of it.
TEST(Simplifier, ALargerLimitLeavesNoMoreTriangles) {
  for (const Case& c :
       {Case{"fandisk", load("fandisk.off")}, Case{"dense anchor", load("anchor_dense.off")},
        Case{"knot", load("knot1.off")}, Case{"torus, with seams", torus(90, 60)},
        Case{"noisy sphere", with_noise(sphere(5), 0.2)}, Case{"open height field", height_field(70)}})
    for (const bool keep_vertices : {false, true}) {
      SCOPED_TRACE(c.name);
      const std::vector<std::size_t> found = counts(c.mesh, 1e-3, 0.03, keep_vertices);
      EXPECT_TRUE(std::ranges::is_sorted(found, std::greater<>{})) << ::testing::PrintToString(found);
      EXPECT_LT(found.back(), c.mesh.triangles.size() / 10);
    }
}

/// A plate with a pocket of n × n squares, of two triangles each, seen from above; closed.
Mesh plate(std::uint32_t n) {
  Mesh mesh;
  const auto side = static_cast<double>(n);
  const auto in_pocket = [&](std::uint32_t i) { return 4 * i > n && 4 * i < 3 * n; };
  for (const double bottom : {0.0, 1.0})
    for (std::uint32_t i = 0; i <= n; ++i)
      for (std::uint32_t j = 0; j <= n; ++j)
        mesh.positions.push_back({static_cast<double>(i) / side, static_cast<double>(j) / side,
                                  bottom > 0 ? -0.2 : (in_pocket(i) && in_pocket(j) ? -0.1 : 0.0)});
  const std::uint32_t row = n + 1, below = row * row;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * row + j;
      add(a, a + row, a + row + 1, a + 1);
      add(below + a, below + a + 1, below + a + row + 1, below + a + row);
    }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t left = i, right = n * row + i, front = i * row, back = i * row + n;
    add(left, left + 1, below + left + 1, below + left);
    add(right + 1, right, below + right, below + right + 1);
    add(front + row, front, below + front, below + front + row);
    add(back, back + row, below + back + row, below + back);
  }
  return mesh;
}

// Once, such plates were left whole at 1 %, and a note said that no collapse kept the limit.
TEST(Simplifier, APlateWithAPocketNeedsFewTriangles) {
  const Mesh mesh = plate(48);
  ASSERT_TRUE(inspect(mesh).closed);
  Simplifier simplifier(mesh);
  for (const double share : {1e-3, 1e-2}) {
    const Simplified s = simplifier.to_deviation(share * box_diagonal(mesh));
    EXPECT_FALSE(s.stopped);
    EXPECT_LT(s.mesh.triangles.size(), 150U);
    EXPECT_TRUE(inspect(s.mesh).closed);
    expect_certificate(mesh, s);
  }
}

TEST(Simplifier, FreelyPlacedVerticesLeaveFewerTriangles) {
  const Mesh mesh = sphere(5);
  Simplifier simplifier(mesh);
  const std::size_t free = simplifier.to_deviation(0.01).mesh.triangles.size();
  const std::size_t kept = simplifier.to_deviation(0.01, {.keep_vertices = true}).mesh.triangles.size();
  EXPECT_LT(3 * free, 2 * kept);
}

// Two steps to 1 % of this mesh end 9.7 away from it, and one step 5.8.
TEST(Simplifier, OneStepIsTakenWhereTwoDeviateMore) {
  const Mesh mesh = load("armadillo.off");
  const Simplified s = Simplifier(mesh).to_triangles(mesh.triangles.size() / 100);
  EXPECT_LE(s.mesh.triangles.size(), mesh.triangles.size() / 100);
  EXPECT_LT(s.deviation.upper, 6.5);
}

TEST(Simplifier, LevelsAreMonotone) {
  const Mesh mesh = with_noise(torus(100, 60), 0.1);
  Simplifier simplifier(mesh);
  std::vector<Simplified> levels;
  levels.reserve(4);
  for (int i = 0; i < 4; ++i) {
    const double limit = 0.01 * std::ldexp(1, i);
    levels.push_back(simplifier.to_deviation(limit, {.from = i > 0 ? &levels[i - 1] : nullptr}));
    EXPECT_LE(levels[i].deviation.upper, limit);
    expect_certificate(mesh, levels[i]);
    if (i == 0) continue;
    EXPECT_LE(levels[i].mesh.triangles.size(), levels[i - 1].mesh.triangles.size());
    EXPECT_GE(levels[i].estimate, levels[i - 1].estimate);
    expect_vertices_of(levels[i - 1].mesh, levels[i].mesh);
  }
  const Simplified fewer = simplifier.to_triangles(500, {.from = &levels[0]});
  EXPECT_LE(fewer.mesh.triangles.size(), 500U);
  expect_certificate(mesh, fewer);
}

// A point of a torus of height z = sin v and around by u has these texture coordinates.
TEST(Simplifier, KeepsTextureCoordinatesAndSeams) {
  const Mesh mesh = torus(96, 64);
  std::set<std::pair<Vec3, Vec2>> corners;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) corners.insert({mesh.positions[mesh.triangles[f][k]], mesh.corner_uvs[f][k]});
  Simplifier simplifier(mesh);
  for (const Simplified& s : {simplifier.to_triangles(1500), simplifier.to_deviation(0.02)}) {
    ASSERT_EQ(s.mesh.corner_uvs.size(), s.mesh.triangles.size());
    EXPECT_LT(s.mesh.triangles.size(), mesh.triangles.size() / 2);
    EXPECT_TRUE(inspect(s.mesh).closed) << "seams are no gaps";
    for (std::size_t f = 0; f < s.mesh.triangles.size(); ++f)
      for (int k = 0; k < 3; ++k)
        EXPECT_TRUE(corners.contains({s.mesh.positions[s.mesh.triangles[f][k]], s.mesh.corner_uvs[f][k]}));
    // No face spans a seam: their texture coordinates would be torn.
    for (const auto& uv : s.mesh.corner_uvs)
      for (int k = 0; k < 2; ++k)
        EXPECT_LT(std::max({uv[0][k], uv[1][k], uv[2][k]}) - std::min({uv[0][k], uv[1][k], uv[2][k]}), 0.5);
  }
}

/// A sphere by latitude and longitude. At the poles, each face has texture coordinates of its own: those in
/// the middle of its other side, or above the first end of it.
Mesh globe(std::uint32_t around, std::uint32_t rings, double at_pole) {
  Mesh mesh;
  for (std::uint32_t j = 0; j <= rings; ++j)
    for (std::uint32_t i = 0; i < around; ++i) {
      const double polar = std::numbers::pi * j / rings, azimuth = 2 * std::numbers::pi * i / around;
      const double radius = j == 0 || j == rings ? 0 : std::sin(polar);
      mesh.positions.push_back({radius * std::cos(azimuth), radius * std::sin(azimuth), -std::cos(polar)});
    }
  const auto add = [&](std::uint32_t column, std::array<std::array<std::uint32_t, 2>, 3> corners) {
    Triangle& t = mesh.triangles.emplace_back();
    auto& uvs = mesh.corner_uvs.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const auto [i, j] = corners[k];
      const bool is_pole = j == 0 || j == rings;
      t[k] = j * around + (is_pole ? 0 : i % around);
      uvs[k] = {(is_pole ? column + at_pole : i) / around, double{1} * j / rings};
    }
  };
  for (std::uint32_t j = 0; j < rings; ++j)
    for (std::uint32_t i = 0; i < around; ++i) {
      if (j > 0) add(i, {{{i, j}, {i + 1, j}, {i, j + 1}}});
      if (j + 1 < rings) add(i, {{{i + 1, j}, {i + 1, j + 1}, {i, j + 1}}});
    }
  return mesh;
}

double area_in_texture(const std::array<Vec2, 3>& uv) {
  return cross(uv[1] - uv[0], uv[2] - uv[0]);
}

// Regression: the faces at the poles stayed, so that 96 faces of a sphere of 432 deviated by 1.06.
TEST(Simplifier, PolesCollapseToo) {
  for (const double at_pole : {0.0, 0.5}) {
    const Mesh mesh = globe(24, 10, at_pole);
    ASSERT_EQ(mesh.triangles.size(), 432u);
    ASSERT_TRUE(inspect(mesh).closed && inspect(mesh).oriented);
    for (const auto& uv : mesh.corner_uvs) ASSERT_GT(area_in_texture(uv), 0);
    const Simplified s = Simplifier(mesh).to_triangles(96);
    EXPECT_EQ(s.mesh.triangles.size(), 96u);
    EXPECT_LT(s.deviation.upper, 0.15);
    EXPECT_TRUE(inspect(s.mesh).closed);
    double sum = 0;
    for (std::size_t f = 0; f < 96; ++f) {
      const auto& uv = s.mesh.corner_uvs[f];
      EXPECT_GT(area_in_texture(uv), 0) << f;
      sum += area_in_texture(uv) / 2;
      for (int k = 0; k < 3; ++k)  // a pole is above the other corners, where the texture was
        if (uv[k][1] == 0 || uv[k][1] == 1) {
          const double a = uv[(k + 1) % 3][0], b = uv[(k + 2) % 3][0];
          EXPECT_GE(uv[k][0], std::min(a, b) - 1.0 / 24);
          EXPECT_LE(uv[k][0], std::max(a, b) + 1.0 / 24);
        }
    }
    EXPECT_LE(sum, 1.0) << "faces overlap in the texture";
    // What is not collapsed keeps its texture coordinates.
    const Mesh same = Simplifier(mesh).to_triangles(432).mesh;
    EXPECT_EQ(same.corner_uvs, mesh.corner_uvs);
  }
}

// Regression: collapses onto straight seams left faces without an area in the texture, which cannot be baked.
TEST(Simplifier, FacesKeepAnAreaInTheTexture) {
  const Mesh round = globe(60, 40, 0), charts = with_own_uvs(load("anchor_dense.off"), 1024);
  for (const Mesh* mesh : {&round, &charts}) {
    Simplifier simplifier(*mesh);
    std::vector<Simplified> results;
    for (const double share : {0.5, 0.2, 0.1, 0.05})
      results.push_back(simplifier.to_triangles(
          static_cast<std::size_t>(share * static_cast<double>(mesh->triangles.size()))));
    results.push_back(simplifier.to_deviation(0.01 * box_diagonal(*mesh)));
    const double turn = area_in_texture(mesh->corner_uvs[0]) > 0 ? 1 : -1;
    const auto sorted = [](std::array<Vec2, 3> uv) {
      std::ranges::sort(uv);
      return uv;
    };
    std::set<std::array<Vec2, 3>> faces;
    for (const auto& uv : mesh->corner_uvs) faces.insert(sorted(uv));
    for (const Simplified& s : results)
      for (std::array<Vec2, 3> uv : s.mesh.corner_uvs) {
        if (faces.contains(sorted(uv))) continue;  // of the input, whatever it is
        for (const bool is_up : {true, false}) {
          for (Vec2& at : uv) at = {static_cast<float>(at[0]), static_cast<float>(is_up ? at[1] : 1 - at[1])};
          EXPECT_GT((is_up ? turn : -turn) * area_in_texture(uv), 0) << "of " << s.mesh.triangles.size();
        }
      }
  }
}

// Regression: normals, colours and materials were lost.
TEST(Simplifier, RegionsKeepTheirBorders) {
  Mesh mesh = sphere(5);
  std::vector<std::uint32_t> regions;
  const auto middle_of = [](const Mesh& m, std::size_t f) {
    const auto& [a, b, c] = m.triangles[f];
    return (1.0 / 3) * (m.positions[a] + m.positions[b] + m.positions[c]);
  };
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    regions.push_back(middle_of(mesh, f)[2] > 0 ? 7 : 3);
  std::set<Vec3> border;  // vertices with faces of both
  for (int region : {3, 7}) {
    std::set<Vec3> of_region;
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
      if (regions[f] == static_cast<std::uint32_t>(region))
        for (const std::uint32_t v : mesh.triangles[f]) of_region.insert(mesh.positions[v]);
    if (region == 3)
      border = of_region;
    else
      std::erase_if(border, [&](const Vec3& p) { return !of_region.contains(p); });
  }
  Simplifier simplifier(mesh, regions);
  const Simplified first = simplifier.to_deviation(0.02),
                   second = simplifier.to_deviation(0.05, {.from = &first});
  for (const Simplified* s : {&first, &second}) {
    EXPECT_LT(s->mesh.triangles.size(), mesh.triangles.size() / 4);
    EXPECT_TRUE(inspect(s->mesh).closed);
    ASSERT_EQ(s->source_faces.size(), s->mesh.triangles.size());
    std::array<std::set<std::uint32_t>, 2> vertices;
    for (std::size_t f = 0; f < s->mesh.triangles.size(); ++f) {
      const std::uint32_t region = regions[s->source_faces[f]];
      for (const std::uint32_t v : s->mesh.triangles[f]) vertices[region == 7 ? 1 : 0].insert(v);
      const double height = middle_of(s->mesh, f)[2];
      EXPECT_TRUE(std::abs(height) < 0.1 || region == (height > 0 ? 7u : 3u)) << height;
    }
    for (const std::uint32_t v : vertices[0])
      EXPECT_TRUE(!vertices[1].contains(v) || border.contains(s->mesh.positions[v]));
  }
  // Where no vertex has two regions, vertices are placed freely.
  const Mesh two = joined(sphere(4), moved(sphere(4), {3, 0, 0}));
  std::vector<std::uint32_t> of_two(two.triangles.size(), 1);
  std::fill_n(of_two.begin(), of_two.size() / 2, 0u);
  for (const bool single_precision : {false, true}) {
    const Simplified free =
        Simplifier(two, of_two).to_deviation(0.03, {.single_precision = single_precision});
    EXPECT_EQ(
        free.mesh.triangles.size(),
        Simplifier(two).to_deviation(0.03, {.single_precision = single_precision}).mesh.triangles.size());
    ASSERT_EQ(free.source_faces.size(), free.mesh.triangles.size());
    for (std::size_t f = 0; f < free.mesh.triangles.size(); ++f)
      EXPECT_EQ(free.source_faces[f], middle_of(free.mesh, f)[0] > 1.5 ? of_two.size() / 2 : 0u);
  }
  EXPECT_THROW(Simplifier(mesh, of_two), Error);
}

/// Each face in four, which share the middles of their edges.
Mesh divided(const Mesh& mesh) {
  Mesh result{.positions = mesh.positions, .triangles = {}, .corner_uvs = {}};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(result.positions.size()));
    if (is_new) result.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
    return at->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const Triangle& t : {Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
      result.triangles.push_back(t);
  }
  return result;
}

TEST(Simplifier, CornersKeepNormalsAndColours) {
  // A box of many faces whose normals jump at its edges, and whose colours are coordinates.
  Mesh mesh = box({1, 2, 3});
  for (int i = 0; i < 4; ++i) mesh = divided(mesh);
  MeshAttribute normal{.name = "normal", .components = 3, .values = {}, .rows = {}};
  MeshAttribute color{.name = "color", .components = 3, .values = {}, .rows = {}};
  std::vector<Triangle> of_faces;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto& [a, b, c] = mesh.triangles[f];
    const Vec3 n =
        normalized(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
    for (const double x : n) normal.values.push_back(static_cast<float>(x));
    of_faces.push_back({f, f, f});
  }
  for (const Vec3& p : mesh.positions)
    for (const double x : p) color.values.push_back(static_cast<float>(x));
  normal.rows = std::make_shared<const std::vector<Triangle>>(of_faces);
  color.rows = std::make_shared<const std::vector<Triangle>>(mesh.triangles);
  const std::vector<MeshAttribute> attributes{normal, color};
  const Sites sites(mesh);
  for (const bool keep_vertices : {true, false}) {
    const Mesh low = Simplifier(mesh).to_deviation(0.01, {.keep_vertices = keep_vertices}).mesh;
    EXPECT_LT(low.triangles.size(), 40u);
    const std::vector<MeshAttribute> carried = carried_attributes(sites, attributes, low);
    ASSERT_EQ(carried.size(), 2u);
    EXPECT_EQ(carried[0].name, "normal");
    EXPECT_LE(carried[1].values.size(), 3 * low.positions.size()) << "colours do not jump";
    for (std::size_t f = 0; f < low.triangles.size(); ++f) {
      const auto& [a, b, c] = low.triangles[f];
      const Vec3 n =
          normalized(cross(low.positions[b] - low.positions[a], low.positions[c] - low.positions[a]));
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t of_normal = (*carried[0].rows)[f][k], of_color = (*carried[1].rows)[f][k];
        for (int i = 0; i < 3; ++i) {
          EXPECT_NEAR(carried[0].values[3 * of_normal + i], n[i], 0.03);
          EXPECT_NEAR(carried[1].values[3 * of_color + i], low.positions[low.triangles[f][k]][i], 0.011);
        }
      }
    }
  }
  MeshAttribute others = normal;
  others.rows = std::make_shared<const std::vector<Triangle>>(3);
  EXPECT_THROW((void)carried_attributes(sites, std::vector{others}, mesh), Error);
}

TEST(Simplifier, KeepsBordersAndWinding) {
  const Mesh mesh = height_field(60);
  Simplifier simplifier(mesh);
  const Simplified s = simplifier.to_deviation(0.01 * box_diagonal(mesh));
  EXPECT_FALSE(s.stopped);
  const auto upwards = [](const Mesh& m) {
    double area = 0;
    for (const Triangle& t : m.triangles) {
      const Vec3 &a = m.positions[t[0]], &b = m.positions[t[1]], &c = m.positions[t[2]];
      area += cross(b - a, c - a)[2] / 2;
    }
    return area;
  };
  EXPECT_NEAR(upwards(s.mesh), upwards(mesh), 0.02 * std::abs(upwards(mesh)));
  EXPECT_TRUE(inspect(s.mesh).oriented);
}

TEST(Simplifier, FlatSurfacesNeedFewTriangles) {
  Mesh mesh = height_field(80);
  for (Vec3& p : mesh.positions) p[2] = 0;
  mesh.corner_uvs.clear();
  Simplifier simplifier(mesh);
  const Simplified s = simplifier.to_deviation(1e-4 * box_diagonal(mesh));
  EXPECT_LE(s.mesh.triangles.size(), 100U);
  EXPECT_LE(s.deviation.upper, 1e-4 * box_diagonal(mesh));
  EXPECT_LE(simplifier.to_triangles(200).deviation.upper, 2e-6 * box_diagonal(mesh));
}

TEST(Simplifier, NeverReturnsNothing) {
  for (const Mesh& mesh : {sphere(3), cube(), tetrahedron(), single_triangle(), square(1, 0)}) {
    Simplifier simplifier(mesh);
    for (const Simplified& s :
         {simplifier.to_triangles(1), simplifier.to_deviation(100 * box_diagonal(mesh))}) {
      EXPECT_GE(s.mesh.triangles.size(), 1U);
      EXPECT_NO_THROW(validate(s.mesh));
      expect_certificate(mesh, s);
    }
  }
}

TEST(Simplifier, ReturnsTheInputWhereNothingKeepsTheLimit) {
  const Mesh mesh = with_noise(sphere(3), 0.3);
  Simplifier simplifier(mesh);
  const Simplified s = simplifier.to_deviation(1e-7);
  EXPECT_TRUE(s.stopped);
  EXPECT_EQ(s.mesh.triangles, mesh.triangles);
  EXPECT_EQ(s.mesh.positions, mesh.positions);
  EXPECT_EQ(s.deviation.upper, 0);
  EXPECT_EQ(s.deviation.certainty, Certainty::exact);
  const Simplified all = simplifier.to_triangles(1'000'000);
  EXPECT_EQ(all.mesh.triangles, mesh.triangles);
  EXPECT_FALSE(all.stopped) << "there are no more than that";
}

TEST(Simplifier, MeasuresWhatRoundingToFloatMoves) {
  const Mesh mesh = moved(sphere(4), {1e6, 0, 0});  // floats are 1/16 apart there
  Simplifier simplifier(mesh);
  const Simplified s = simplifier.to_triangles(500, {.single_precision = true});
  for (const Vec3& p : s.mesh.positions)
    for (const double x : p) EXPECT_EQ(x, static_cast<float>(x));
  EXPECT_GT(s.deviation.lower, 0.02);
  expect_certificate(mesh, s);
  EXPECT_THAT(error_of([&] { return simplifier.to_deviation(1e-3, {.single_precision = true}); }),
              HasSubstr("rounded to float"));
  for (const double limit : {0.1, 0.2, 0.5})  // of different numbers of vertices
    for (const Vec3& p : simplifier.to_deviation(limit, {.single_precision = true}).mesh.positions)
      for (const double x : p) EXPECT_EQ(x, static_cast<float>(x)) << limit;
}

// Once, a face whose corners became one when rounded counted as a point, which readers of the file do not
// have.
TEST(Simplifier, AFaceThatVanishesByRoundingIsNotInTheResult) {
  Mesh speck = moved(single_triangle(), {});
  for (Vec3& p : speck.positions) p = Vec3{1000.00001, 1000.00001, 1000.00001} + 1e-6 * p;
  const Mesh mesh = joined(sphere(4), speck);
  Simplifier simplifier(mesh);
  const Simplified s = simplifier.to_triangles(500, {.single_precision = true});
  EXPECT_GT(s.deviation.lower, 1000);
  EXPECT_THAT(error_of([&] { return simplifier.to_deviation(0.05, {.single_precision = true}); }),
              HasSubstr("rounded to float"));
}

// Once, the mesh itself was refused where rounding changes nothing.
TEST(Simplifier, AMeshOfFloatsIsKeptExactlyWhateverTheLimit) {
  const Mesh mesh = cube();
  Simplifier simplifier(mesh);
  const Simplified s = simplifier.to_deviation(1e-14, {.single_precision = true});
  EXPECT_EQ(s.mesh.triangles.size(), mesh.triangles.size());
  EXPECT_EQ(s.deviation.certainty, Certainty::exact);
  EXPECT_EQ(s.deviation.upper, 0);
}

// Once, a face with two corners in the same place was part of the input and not of the result, whose
// deviation was 0.
TEST(Simplifier, FacesWithCornersInTheSamePlaceAreNoPartOfTheSurface) {
  const Mesh mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {5, 0, 0}, {0, 0, 0}},
                  .triangles = {{0, 1, 2}, {3, 4, 5}},
                  .corner_uvs = {}};
  Simplifier simplifier(mesh);
  const Simplified s = simplifier.to_deviation(0.01);
  EXPECT_EQ(s.mesh.triangles.size(), 1u);
  EXPECT_EQ(s.deviation.upper, 0);
}

TEST(Simplifier, RefusesWhatIsNoTarget) {
  Simplifier simplifier(cube());
  for (const double limit :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THAT(error_of([&] { return simplifier.to_deviation(limit); }), HasSubstr("greater than 0"));
  EXPECT_THAT(error_of([&] { return simplifier.to_triangles(0); }), HasSubstr("at least one triangle"));
  EXPECT_THROW(Simplifier(Mesh{}), Error);
  EXPECT_THROW(
      Simplifier(
          Mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, .triangles = {{0, 1, 2}}, .corner_uvs = {}}),
      Error);
}

TEST(Simplifier, IsCancelled) {
  const Mesh mesh = sphere(5);
  Simplifier simplifier(mesh);
  EXPECT_THROW(
      (void)simplifier.to_deviation(0.01, {.progress = [](std::string_view, double) { return false; }}),
      Cancelled);
  EXPECT_FALSE(simplifier.to_deviation(0.01).mesh.triangles.empty()) << "usable afterwards";
}

TEST(Simplifier, ReportsWhatItCost) {
  Simplifier simplifier(sphere(5));
  (void)simplifier.to_triangles(500);
  const SimplifyReport& report = simplifier.report();
  EXPECT_GT(report.sites_ms, 0);
  EXPECT_GT(report.collapse_ms, 0);
  EXPECT_GT(report.deviation_ms, 0);
  EXPECT_EQ(report.candidates, 2U) << "reached in one step and in two";
}

}  // namespace
}  // namespace sdm::test
