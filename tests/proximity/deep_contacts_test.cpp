// Contacts of unions of boxes in deep overlap: every connected region of the overlap has one, and the
// contacts of separating_contacts() push the bodies apart.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "scenes/blocks.h"
#include "support/oracle.h"

namespace sdm::test {
namespace {

using scenes::Blocks, scenes::union_of;

/// n·x ≤ height.
struct HalfSpace {
  Vec3 n;
  double height;
};
using Convex = std::vector<HalfSpace>;

Convex convex(const Box& block, const Transform& pose) {
  Convex result;
  const Vec3 origin = pose({});
  for (int k = 0; k < 3; ++k) {
    Vec3 e{};
    e[k] = 1;
    const Vec3 n = pose(e) - origin;
    result.push_back({n, block.upper[k] + dot(n, origin)});
    result.push_back({-n, -block.lower[k] - dot(n, origin)});
  }
  return result;
}

bool contains(const Convex& c, const Vec3& p, double tolerance) {
  return std::ranges::all_of(c, [&](const HalfSpace& h) { return dot(h.n, p) <= h.height + tolerance; });
}

/// Whether the common part has a volume: the mean of its corners is inside.
bool overlap(const std::vector<const Convex*>& of) {
  Convex all;
  for (const Convex* c : of) all.insert(all.end(), c->begin(), c->end());
  Vec3 sum{};
  int corners = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j)
      for (std::size_t k = j + 1; k < all.size(); ++k) {
        const Vec3 across = cross(all[j].n, all[k].n);
        const double volume = dot(all[i].n, across);
        if (std::abs(volume) < 1e-9) continue;
        const Vec3 p = (1 / volume) * (all[i].height * across + all[j].height * cross(all[k].n, all[i].n) +
                                       all[k].height * cross(all[i].n, all[j].n));
        if (contains(all, p, 1e-9)) {
          sum += p;
          ++corners;
        }
      }
  return corners > 0 && contains(all, (1.0 / corners) * sum, -1e-9);
}

/// The connected regions of the overlap of two unions.
class Regions {
 public:
  Regions(const Blocks& a, const Blocks& b, const Transform& pose_of_b) {
    for (const Box& block : a) a_.push_back(convex(block, {}));
    for (const Box& block : b) b_.push_back(convex(block, pose_of_b));
    for (const Convex& of_a : a_)
      for (const Convex& of_b : b_)
        if (overlap({&of_a, &of_b})) cells_.push_back({&of_a, &of_b, static_cast<int>(cells_.size())});
    for (bool again = true; again;) {
      again = false;
      for (Cell& x : cells_)
        for (Cell& y : cells_)
          if (x.region < y.region && overlap({x.a, x.b, y.a, y.b})) {
            y.region = x.region;
            again = true;
          }
    }
  }
  /// The region that a point is in or next to, or −1.
  [[nodiscard]] int at(const Vec3& p) const {
    for (const Cell& cell : cells_)
      if (contains(*cell.a, p, 1e-6) && contains(*cell.b, p, 1e-6)) return cell.region;
    return -1;
  }

 private:
  struct Cell {
    const Convex *a, *b;
    int region;
  };
  std::vector<Convex> a_, b_;
  std::vector<Cell> cells_;
};

double depth_in(const Mesh& solid, const Vec3& p) {
  return oracle::winding_number(solid, p) != 0 ? oracle::brute_force(solid, p) : 0;
}

/// Some depths of the surface of `on` in `other`, the largest of each region.
void add_depths(const Regions& regions, const Mesh& on, const Mesh& other, std::map<int, double>& depths) {
  constexpr int kSteps = 8;
  for (const auto& [a, b, c] : on.triangles)
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j) {
        const Vec3 p = (1.0 / kSteps) * (double(i) * on.positions[a] + double(j) * on.positions[b] +
                                         double(kSteps - i - j) * on.positions[c]);
        if (const int region = regions.at(p); region >= 0)
          depths[region] = std::max(depths[region], depth_in(other, p));
      }
}

class Jacks {
 public:
  explicit Jacks(unsigned seed) : random_(seed) {}

  [[nodiscard]] Blocks blocks() {
    const double w = 0.2 + 0.3 * number();
    Blocks result;
    switch (std::uniform_int_distribution<int>(0, 2)(random_)) {
      case 0:  // three bars that cross
        for (int k = 0; k < 3; ++k) {
          Box bar{{-w, -w, -w}, {w, w, w}};
          bar.lower[k] = -1;
          bar.upper[k] = 1;
          result.push_back(bar);
        }
        return result;
      case 1:  // an L
        return {{{-1, -1, -w}, {1, -1 + 2 * w, w}}, {{-1, -1, -w}, {-1 + 2 * w, 1, w}}};
      default:  // a U
        return {{{-1, -1, -w}, {1, -1 + 1.2 * w, w}},
                {{-1, -1, -w}, {-1 + 1.2 * w, 1, w}},
                {{1 - 1.2 * w, -1, -w}, {1, 1, w}}};
    }
  }
  [[nodiscard]] Transform pose() {
    std::normal_distribution<double> normal;
    const auto vec = [&] { return Vec3{normal(random_), normal(random_), normal(random_)}; };
    const Vec3 direction = normalized(vec()), axis = vec();
    return Transform::translation(number() * direction) *
           Transform::quaternion({normal(random_), axis[0], axis[1], axis[2]});
  }

 private:
  double number() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  std::mt19937 random_;
};

// The leg of a U along y, in a box. Edges of the crossbar leave the box from a corner that is little deeper
// than 0.007 in it, and are 0.34 deep between: the corner had the only contact of each.
TEST(DeepContacts, OfAnEdgeWithAnEndNearTheSurfaceAreDeep) {
  const Blocks u{{{-1, -1, -0.29}, {1, -0.66, 0.29}},
                 {{-1, -1, -0.29}, {-0.66, 1, 0.29}},
                 {{0.66, -1, -0.29}, {1, 1, 0.29}}};
  const Blocks box{{{-0.667, -1.03, -0.92}, {0.06, -0.3, 1.08}}};
  ProximityQuery query(union_of(u), union_of(box));
  ASSERT_FALSE(query.contacts().empty());
  double deepest = 0;
  for (const Contact& c : query.contacts()) deepest = std::max(deepest, c.depth);
  EXPECT_GT(deepest, 0.5 * query.penetration_depth()->lower);
  EXPECT_LE(deepest, query.penetration_depth()->upper);
}

// The same, as the box moves by small steps: other contacts of these edges come and go, and the deep points
// keep their ids.
TEST(DeepContacts, OfAnEdgeKeepTheirIds) {
  const Blocks u{{{-1, -1, -0.29}, {1, -0.66, 0.29}},
                 {{-1, -1, -0.29}, {-0.66, 1, 0.29}},
                 {{0.66, -1, -0.29}, {1, 1, 0.29}}};
  const Blocks box{{{-0.667, -1.03, -0.92}, {0.06, -0.3, 1.08}}};
  ProximityQuery query(union_of(u), union_of(box));
  std::set<std::uint64_t> deep;
  std::set<std::size_t> counts;
  constexpr int kSteps = 100;
  for (int step = 0; step <= kSteps; ++step) {
    const double s = static_cast<double>(step) / kSteps;
    query.set_pose(1, Transform::translation({0.02 * s - 0.01, 0.02 - 0.05 * s, 0.1 * s}) *
                          Transform::rotation({3 * s, 2 * s, 5 * s - 2}));
    std::size_t count = 0;
    for (const Contact& c : query.contacts()) {
      count += c.depth > 0.2;
      if (c.depth > 0.2) deep.insert(c.id);
    }
    EXPECT_EQ(count, 2u) << "at step " << step;
    counts.insert(query.contacts().size());
  }
  EXPECT_EQ(deep.size(), 2u);
  EXPECT_GE(counts.size(), 3u);
}

// A rod in a box, whose ends are little below the surface: only its edges are deep.
TEST(DeepContacts, OfAnEdgeInsideAreDeep) {
  for (const double beyond : {0.01, 0.05, 0.3}) {
    const double half = 1 + beyond;
    const Blocks rod{{{-1, -0.02, -0.02}, {1, 0.02, 0.02}}}, box{{{-half, -half, -half}, {half, half, half}}};
    ProximityQuery query(union_of(rod), union_of(box));
    query.set_pose(0, Transform::rotation({0, 1, 2}));
    std::set<std::uint64_t> ids;
    double deepest = 0;
    for (const Contact& c : query.contacts()) {
      deepest = std::max(deepest, c.depth);
      ids.insert(c.id);
    }
    EXPECT_GT(deepest, 0.5 * query.penetration_depth()->lower);
    EXPECT_LE(deepest, query.penetration_depth()->upper);
    EXPECT_EQ(ids.size(), query.contacts().size());
  }
}

TEST(DeepContacts, AreInEachRegionOfAnOverlap) {
  int checked = 0, shallow = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Jacks jacks(seed);
    const Blocks a = jacks.blocks(), b = jacks.blocks();
    const Transform pose = jacks.pose();
    const Mesh mesh_a = union_of(a), mesh_b = union_of(b);
    Mesh placed_b = mesh_b;
    for (Vec3& p : placed_b.positions) p = pose(p);
    const Regions regions(a, b, pose);
    std::map<int, double> depths, found;
    add_depths(regions, mesh_a, placed_b, depths);
    add_depths(regions, placed_b, mesh_a, depths);
    ProximityQuery query(mesh_a, mesh_b);
    query.set_pose(1, pose);
    for (const Contact& c : query.contacts()) {
      double& deepest = found[regions.at(c.id >> 63 == 0 ? c.point1 : c.point2)];
      deepest = std::max(deepest, c.depth);
      EXPECT_LE(c.depth, query.penetration_depth()->upper + 1e-9);
    }
    for (const auto& [region, depth] : depths) {
      if (depth < 1e-3) continue;
      ++checked;
      EXPECT_GT(found[region], 0) << "depth " << depth;
      // Edges have contacts at least half as deep as they are, but for 1/64 of the size; a face may be
      // deeper.
      shallow += found[region] < 0.5 * depth - 0.125;
    }
  }
  EXPECT_GT(checked, 60);
  EXPECT_LE(shallow, checked / 50);
}

TEST(DeepContacts, SeparateUnionsOfBoxesInTwentySteps) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    Jacks jacks(1000 + seed);
    const Blocks a = jacks.blocks(), b = jacks.blocks();
    ProximityQuery query(union_of(a), union_of(b));
    query.set_pose(0, jacks.pose());
    for (int step = 0; step < 20 && query.colliding(); ++step) {
      Vec3 by{};
      for (const Contact& c : query.separating_contacts())
        if (const double rest = c.depth - dot(c.normal, by); rest > 0) by += rest * c.normal;
      query.set_pose(0, Transform::translation((1 + 1e-6) * by + 1e-9 * normalized(by)) * query.pose(0));
    }
    EXPECT_FALSE(query.colliding());
  }
}

}  // namespace
}  // namespace sdm::test
