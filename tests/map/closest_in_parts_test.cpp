// Parts of O2, divided at random, against the reference engine for the whole of it: bit for bit.
#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/error.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <vector>

#include "support/shapes.h"

namespace sdm::test {
namespace {

struct Part {
  Mesh mesh;
  std::vector<std::uint32_t> vertices, edges, faces;  ///< their numbers in the whole
  [[nodiscard]] PartNumbers numbers() const { return {vertices, edges, faces}; }
};

Part part_of(const Mesh& whole, const Sites& sites, std::vector<std::uint32_t> faces) {
  Part part;
  part.faces = std::move(faces);
  for (const std::uint32_t f : part.faces)
    part.vertices.insert(part.vertices.end(), whole.triangles[f].begin(), whole.triangles[f].end());
  std::ranges::sort(part.vertices);
  part.vertices.erase(std::unique(part.vertices.begin(), part.vertices.end()), part.vertices.end());
  for (const std::uint32_t v : part.vertices) part.mesh.positions.push_back(whole.positions[v]);
  const auto local = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(part.vertices, v) - part.vertices.begin());
  };
  for (const std::uint32_t f : part.faces) {
    const Triangle& t = whole.triangles[f];
    part.mesh.triangles.push_back({local(t[0]), local(t[1]), local(t[2])});
  }
  const Sites own(part.mesh);
  for (const auto& [a, b] : own.edges()) {
    const std::array<std::uint32_t, 2> edge{part.vertices[a], part.vertices[b]};
    part.edges.push_back(
        static_cast<std::uint32_t>(std::ranges::lower_bound(sites.edges(), edge) - sites.edges().begin()));
  }
  return part;
}

// Duplicate faces stay together.
std::vector<Part> divided(const Mesh& mesh, const Sites& sites, std::uint32_t count, std::mt19937& random) {
  std::map<Triangle, std::uint32_t> part_of_corners;
  std::vector<std::vector<std::uint32_t>> faces(count);
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    Triangle corners = mesh.triangles[f];
    std::ranges::sort(corners);
    faces[part_of_corners.try_emplace(corners, random() % count).first->second].push_back(f);
  }
  std::vector<Part> parts;
  for (auto& of_part : faces)
    if (!of_part.empty()) parts.push_back(part_of(mesh, sites, std::move(of_part)));
  std::ranges::shuffle(parts, random);
  return parts;
}

void expect_independent_of_parts(const Mesh& mesh, std::span<const Vec3> queries) {
  const Sites sites(mesh);
  const std::vector<ClosestPoint> expected =
      closest_points(sites, queries, {.engine = make_engine("reference")});
  std::mt19937 random(1);
  for (const std::uint32_t count : {1u, 2u, 5u}) {
    std::vector<ClosestInParts> best(queries.size());
    for (const Part& part : divided(mesh, sites, count, random))
      merge_closest(Sites(part.mesh), part.numbers(), queries, best);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      ASSERT_EQ(best[i].distance, expected[i].distance) << count << " parts, query " << i;
      ASSERT_EQ(best[i].type, expected[i].type) << count << " parts, query " << i;
      ASSERT_EQ(best[i].site, expected[i].site) << count << " parts, query " << i;
      for (int k = 0; k < 3; ++k) ASSERT_EQ(queries[i][k] + best[i].vector[k], expected[i].point[k]);
    }
  }
}

// In and around the box of the mesh, at its vertices, and in the middle of pairs of them: many ties.
std::vector<Vec3> queries_for(const Mesh& mesh, std::size_t count) {
  std::mt19937 random(2);
  const Box box = bounds(mesh);
  std::vector<Vec3> queries;
  std::uniform_real_distribution<double> uniform(-0.5, 1.5);
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = box.lower[k] + uniform(random) * (box.upper[k] - box.lower[k]);
    const Vec3 &a = mesh.positions[random() % mesh.positions.size()],
               &b = mesh.positions[random() % mesh.positions.size()];
    queries.push_back(p);
    queries.push_back(a);
    queries.push_back({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2});
  }
  return queries;
}

TEST(ClosestInParts, DoNotDependOnTheParts) {
  std::mt19937 random(3);
  const Mesh meshes[] = {cube(),        sphere(3), torus(16, 12),     height_field(12),
                         needles(1e-5), fan(40),   soup(500, random), with_defects(sphere(2))};
  for (const Mesh& mesh : meshes) expect_independent_of_parts(mesh, queries_for(mesh, 300));
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Mesh mesh = degenerate_soup(200, seed);
    expect_independent_of_parts(mesh, queries_for(mesh, 200));
  }
}

TEST(ClosestInParts, DoNotDependOnThePartsFarFromTheOrigin) {
  const Mesh mesh = moved(torus(16, 12), {5e6, -3e6, 1e6});
  expect_independent_of_parts(mesh, queries_for(mesh, 300));
}

TEST(ClosestInParts, AreSearchedWithinTheDistanceOfEachEntry) {
  const Sites sites(square(2, 1));
  std::vector<std::uint32_t> numbers(8);
  std::iota(numbers.begin(), numbers.end(), 0u);
  const std::span<const std::uint32_t> all = numbers;
  const PartNumbers part{all.first(4), all.first(sites.edges().size()), all.first(2)};
  const std::vector<Vec3> queries{{0, 0, 0}, {0, 0, 0}, {0.5, 0.25, 4}};
  std::vector<ClosestInParts> best(3);
  best[0].distance = 1;
  best[1].distance = 0.99;
  merge_closest(sites, part, queries, best);
  EXPECT_NE(best[0].type, SiteType::none);
  EXPECT_EQ(best[1].type, SiteType::none);
  EXPECT_EQ(best[1].distance, 0.99);
  EXPECT_EQ(best[2].distance, 3);
  EXPECT_EQ(best[2].vector, (Vec3{0, 0, -3}));
}

TEST(ClosestInParts, NumbersMustFitThePart) {
  const Sites sites(single_triangle());
  const std::vector<std::uint32_t> three{0, 1, 2}, down{2, 1, 0}, one{0};
  std::vector<ClosestInParts> best(1);
  const std::vector<Vec3> query{{0, 0, 1}};
  EXPECT_THROW(merge_closest(sites, {three, three, three}, query, best), Error);
  EXPECT_THROW(merge_closest(sites, {three, down, one}, query, best), Error);
  EXPECT_THROW(merge_closest(sites, {three, three, one}, {}, best), Error);
  merge_closest(sites, {three, three, one}, query, best);
  EXPECT_NE(best[0].type, SiteType::none);
}

}  // namespace
}  // namespace sdm::test
