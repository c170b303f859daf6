#include "map/thickness/thickness_search.h"

#include <sdm/error.h>
#include <sdm/thickness.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "closest/facing/outward_normals.h"
#include "core/parallel.h"
#include "tree/fold.h"
#include "tree/visit.h"

namespace sdm::thickness {
namespace {

constexpr double kParallel = 1e-12;   // products of unit vectors up to here count as 0
constexpr double kSlackOfTurn = 0.1;  // degrees: of normals from coordinates in single precision

// n·N of the outward normal N of a face that turns by as much as stops a ball with the inward normal n: with
// the angle A between N and −n, it is −cos A.
double product_of_turn(double angle) {
  return -std::cos(std::min(angle + kSlackOfTurn, 180.0) * std::numbers::pi / 180);
}

}  // namespace

Walls::Walls(const sites::SitesData& sites, double angle)
    : sites_(sites), least_turn_(product_of_turn(angle)), ray_turn_(product_of_turn(std::min(angle, 90.0))) {
  check_options(ThicknessOptions{.angle = angle});
  if (!sites.closed) throw Error("a mesh that is open has no thickness, as it does not bound a solid");
  if (!sites.orientation.orientable)
    throw Error("a mesh that cannot be oriented has no thickness, as it does not bound a solid");
  outward_.resize(sites.mesh.triangles.size());
  constexpr std::size_t kGrain = 4096;
  parallel_for(outward_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      outward_[f] = facing::outward_normal(sites, static_cast<std::uint32_t>(f));
  });
  Box box;
  double largest = 0;
  for (const std::uint32_t f : sites.tree.items)
    for (const Vec3& p : corners_of(sites.mesh, f))
      largest = std::max({largest, std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
  back_ = 8 * std::numeric_limits<double>::epsilon() * largest;
  find_cavities();
  bound_normals();
}

// A cavity is oriented into itself, so that its volume is negative.
void Walls::find_cavities() {
  cavity_.resize(sites_.shells.size());
  parallel_for(cavity_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const auto faces = sites_.shells.of(s);
      const Vec3 origin = corners_of(sites_.mesh, faces.front())[0];
      double volume = 0;
      for (const std::uint32_t f : faces) {
        const auto [a, b, c] = corners_of(sites_.mesh, f);
        const double six_volumes = dot(a - origin, cross(b - origin, c - origin));
        volume += sites_.inverted[f] ? -six_volumes : six_volumes;
      }
      cavity_[s] = volume < 0;
    }
  });
}

void Walls::bound_normals() {
  directions_.resize(sites_.tree.nodes.size());
  tree::for_each_bottom_up(
      sites_.tree,
      [&](std::uint32_t leaf) {
        Box box;
        for (const std::uint32_t f : sites_.tree.items_of(leaf)) extend(box, outward_[f]);
        directions_[leaf] = tree::FloatBox::around(box);
      },
      [&](std::uint32_t node, std::uint32_t left, std::uint32_t right) {
        directions_[node] = unite(directions_[left], directions_[right]);
      });
}

bool Walls::measures(std::uint32_t face) const {
  return !sites_.topology.ignored(face) && outward_[face] != Vec3{};
}

bool Walls::same_solid(std::uint32_t face, std::uint32_t other) const {
  const auto& component = sites_.orientation.component;
  const std::uint32_t a = component[face], b = component[other];
  return a == b || cavity_[a] != 0 || cavity_[b] != 0;
}

void WallSearch::start(std::uint32_t face, std::span<const Vec3> points) {
  face_ = face, stopped_by_ = kNone;
  const Vec3 n = walls_.inward(face);
  starts_.clear();
  for (const Vec3& p : points) starts_.push_back({.origin = p - walls_.back_ * n, .direction = n});
  hits_.resize(points.size());
  const auto leaves_by = [&](std::size_t, std::uint32_t other) {
    return dot(walls_.outward_[other], n) > kParallel && walls_.same_solid(face, other);
  };
  rays::first_hits(walls_.sites_, starts_, rays::filter(leaves_by), scratch_, hits_.data());
  ends_.assign(points.size(), {});
  for (std::size_t i = 0; i < points.size(); ++i)
    if (hits_[i].face != kNone) {
      const double length = std::max(0.0, hits_[i].t - walls_.back_);
      ends_[i] = {length, points[i] + length * n, hits_[i].face};
    }
}

void WallSearch::stop(const Touching& ball, std::uint32_t face, Reached& least) {
  if (!(dot(walls_.outward_[face], ball.n) > walls_.least_turn_) || !walls_.same_solid(face_, face)) return;
  const Reached reached = reach(ball, corners_of(walls_.sites_.mesh, face));
  if (reached.radius < least.radius) least = reached, stopped_by_ = face;
}

// Balls of larger radii contain those of smaller ones, so that a box that the present one does not meet stops
// none of the smaller ones.
WallEnd WallSearch::ball(const Vec3& point, const WallEnd& ray) {
  const sites::SitesData& sites = walls_.sites_;
  const Touching ball{point, walls_.inward(face_)};
  Reached least;
  const std::uint32_t before = std::exchange(stopped_by_, kNone);
  if (ray.face != kNone && dot(walls_.outward_[ray.face], ball.n) > walls_.ray_turn_)
    least = {ray.thickness / 2, ray.point}, stopped_by_ = ray.face;
  if (before != kNone) stop(ball, before, least);
  const Vec3 p = sites.frame.to_unit(point), n = ball.n;
  constexpr double kSlack = 1e-9;  // in the unit frame; more than the rounding of p and of r
  const auto met = [&](const tree::FloatBox& box) {
    const double radius = sites.frame.scale * least.radius;
    double highest = 0;
    for (int k = 0; k < 3; ++k) highest += std::max((box.lo[k] - p[k]) * n[k], (box.hi[k] - p[k]) * n[k]);
    if (highest < -kSlack) return false;
    if (!(radius < 1e6)) return true;
    const double within = radius + kSlack * (1 + radius);
    return squared_norm(tree::gap(box, p + radius * n)) <= within * within;
  };
  const auto turned = [&](const tree::FloatBox& directions) {
    double most = 0;
    for (int k = 0; k < 3; ++k) most += std::max(directions.lo[k] * n[k], directions.hi[k] * n[k]);
    return most > walls_.least_turn_;
  };
  const auto enter = [&](tree::Subtree below) {
    return turned(walls_.directions_[below.root]) && met(sites.tree.box(below.root));
  };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t f : sites.tree.items_of(node)) stop(ball, f, least);
  };
  tree::visit(sites.tree, tree::InOrder{enter, leaf});
  if (stopped_by_ == kNone) return {};
  return {2 * least.radius, least.point, stopped_by_};
}

}  // namespace sdm::thickness
