// The boundary of solids whose faces intersect each other.
#include "inside/solid_boundary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <thread>
#include <vector>

#include "geometry/vec.h"
#include "sites/sites_data.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using inside::SolidBoundary;

// The distance of p from what is left of a rectangle, a box without volume, when the interiors of other boxes
// are removed, from number `first` on.
double distance_from_rest(const Box& rectangle, const std::vector<Box>& others, std::size_t first,
                          const Vec3& p) {
  for (std::size_t i = first; i < others.size(); ++i) {
    const Box& other = others[i];
    bool meets = true;
    for (int k = 0; k < 3; ++k)
      meets &= rectangle.lower[k] < other.upper[k] && other.lower[k] < rectangle.upper[k];
    if (!meets) continue;
    // Up to four rectangles around what is removed.
    double least = std::numeric_limits<double>::infinity();
    Box rest = rectangle;
    for (int k = 0; k < 3; ++k) {
      if (rectangle.lower[k] == rectangle.upper[k]) continue;
      if (rest.lower[k] < other.lower[k]) {
        Box part = rest;
        part.upper[k] = rest.lower[k] = other.lower[k];
        least = std::min(least, distance_from_rest(part, others, i + 1, p));
      }
      if (other.upper[k] < rest.upper[k]) {
        Box part = rest;
        part.lower[k] = rest.upper[k] = other.upper[k];
        least = std::min(least, distance_from_rest(part, others, i + 1, p));
      }
    }
    return least;
  }
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double d = p[k] - std::clamp(p[k], rectangle.lower[k], rectangle.upper[k]);
    squared += d * d;
  }
  return std::sqrt(squared);
}

// From p to the boundary of the union of the boxes.
double distance_from_boundary(const std::vector<Box>& boxes, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Box& box : boxes)
    for (int k = 0; k < 3; ++k)
      for (const double at : {box.lower[k], box.upper[k]}) {
        Box side = box;
        side.lower[k] = side.upper[k] = at;
        least = std::min(least, distance_from_rest(side, boxes, 0, p));
      }
  return least;
}

bool contains(const Box& box, const Vec3& p, double margin) {
  for (int k = 0; k < 3; ++k)
    if (p[k] < box.lower[k] + margin || box.upper[k] - margin < p[k]) return false;
  return true;
}

/// Boxes along the axes that cross each other.
struct CrossedBoxes {
  std::vector<Box> boxes;
  Mesh mesh;
  std::vector<Vec3> points;  ///< inside

  CrossedBoxes(std::mt19937& random, int points_of_each) {
    std::uniform_real_distribution<double> u(0, 1);
    for (int i = 0; i < 4; ++i) {
      Box box;
      for (int k = 0; k < 3; ++k) {
        const double reach = k == i % 3 ? 1 : 0.15;
        const double shift = i == 3 && k != 0 ? 0.2 : 0;
        box.lower[k] = shift - reach * (1 + u(random));
        box.upper[k] = shift + reach * (1 + u(random));
      }
      boxes.push_back(box);
      mesh = test::joined(mesh, test::box(box.lower, box.upper));
      for (int n = 0; n < points_of_each; ++n) {
        Vec3& p = points.emplace_back();
        for (int k = 0; k < 3; ++k) p[k] = box.lower[k] + u(random) * (box.upper[k] - box.lower[k]);
      }
    }
  }
};

struct Boundary {
  Sites sites;
  inside::FaceSides sides;
  SolidBoundary boundary;
  explicit Boundary(const Mesh& mesh)
      : sites(mesh), sides(internals(sites)), boundary(internals(sites), sides) {}
};

TEST(SolidBoundary, IsThatOfTheUnionOfBoxes) {
  std::mt19937 random(3);
  for (int scene = 0; scene < 25; ++scene) {
    const CrossedBoxes crossed(random, 50);
    const Boundary of(crossed.mesh);
    const double size = diagonal(bounds(crossed.mesh));
    for (const Vec3& p : crossed.points) {
      const double expected = distance_from_boundary(crossed.boxes, p);
      const SolidBoundary::Closest found = of.boundary.closest(p);
      EXPECT_LE(found.lower, expected + 1e-9 * size);
      EXPECT_GE(found.upper, expected - 1e-9 * size);
      EXPECT_LE(found.upper - found.lower, 1e-12 * size);
      ASSERT_TRUE(found.point);
      EXPECT_NEAR(norm(*found.point - p), found.upper, 1e-9 * size);
      for (const Box& box : crossed.boxes) EXPECT_FALSE(contains(box, *found.point, 1e-7 * size));
    }
  }
}

TEST(SolidBoundary, DoesNotDependOnOtherCalls) {
  std::mt19937 random(4);
  const CrossedBoxes crossed(random, 100);
  const std::vector<Vec3>& points = crossed.points;
  const Boundary shared(crossed.mesh);
  std::array<std::vector<double>, 4> found;
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < found.size(); ++t)
    threads.emplace_back([&, t] {
      found[t].resize(points.size());
      for (std::size_t n = 0; n < points.size(); ++n) {
        const std::size_t i = t % 2 == 0 ? n : points.size() - 1 - n;
        found[t][i] = shared.boundary.closest(points[i]).upper;
      }
    });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < points.size(); i += 20) {
    const double alone = Boundary(crossed.mesh).boundary.closest(points[i]).upper;
    for (const std::vector<double>& others : found) EXPECT_EQ(others[i], alone);
  }
}

}  // namespace
}  // namespace sdm
