#include "map/measures/thickness_measure.h"

#include <sdm/error.h>
#include <sdm/measure.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "closest/facing/facing_normals.h"
#include "core/parallel.h"
#include "geometry/line_triangle.h"
#include "geometry/vec.h"
#include "tree/fold.h"

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
  arrange_normals();
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

void Walls::arrange_normals() {
  std::vector<tree::FloatBox> below(sites_.tree.nodes.size());
  tree::for_each_bottom_up(
      sites_.tree,
      [&](std::uint32_t leaf) {
        Box box;
        for (const std::uint32_t f : sites_.tree.items_of(leaf)) extend(box, outward_[f]);
        below[leaf] = tree::FloatBox::around(box);
      },
      [&](std::uint32_t node, std::uint32_t left, std::uint32_t right) {
        below[node] = unite(below[left], below[right]);
      });
  const auto& nodes = sites_.wide.nodes;
  normals_.lower.resize(nodes.size());
  normals_.upper.resize(nodes.size());
  for (std::size_t node = 0; node < nodes.size(); ++node)
    for (std::uint32_t slot = 0; slot < nodes[node].count; ++slot) {
      const tree::FloatBox& box = below[nodes[node].source[slot]];
      normals_.lower[node].set(slot, box.lower);
      normals_.upper[node].set(slot, box.upper);
    }
  const auto& leaves = sites_.regions.leaves;
  normals_.of_leaf.resize(leaves.size() - 1);
  for (std::size_t leaf = 0; leaf + 1 < leaves.size(); ++leaf)
    for (std::uint32_t i = leaves[leaf]; i < leaves[leaf + 1]; ++i) {
      const Vec3& n = outward_[sites_.tree.items[i]];
      normals_.of_leaf[leaf].set(
          i - leaves[leaf], {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
    }
}

bool Walls::measures(std::uint32_t face) const {
  return !sites_.topology.ignored(face) && outward_[face] != Vec3{};
}

bool Walls::same_solid(std::uint32_t face, std::uint32_t other) const {
  const auto& component = sites_.orientation.component;
  const std::uint32_t a = component[face], b = component[other];
  return a == b || cavity_[a] != 0 || cavity_[b] != 0;
}

WallEnd WallSearch::ray(std::uint32_t face, const Vec3& point) {
  const Vec3 n = walls_.inward(face);
  const auto leaves_by = [&](std::size_t, std::uint32_t other) {
    return dot(walls_.outward_[other], n) > kParallel && walls_.same_solid(face, other);
  };
  Ray ray{.origin = point - walls_.back_ * n, .direction = n};
  // Nothing behind the face that the ray before hit, if this one hits it too.
  if (hit_ != kNone && leaves_by(0, hit_))
    if (const auto known = line_meets_triangle(ray.origin, n, corners_of(walls_.sites_.mesh, hit_));
        known && known->last >= 0)
      ray.t_max = std::max(known->first, 0.0);
  RayHit hit;
  rays::first_hits(walls_.sites_, {&ray, 1}, rays::filter(leaves_by), scratch_, &hit);
  hit_ = hit.face;
  if (hit.face == kNone) return {};
  const double length = std::max(0.0, hit.t - walls_.back_);
  return {length, point + length * n, hit.face};
}

struct WallSearch::Stops {
  const Walls& walls;
  std::uint32_t from;
  Touching ball;
  TouchedPoint least{};
  std::uint32_t face = kNone;

  // The first one by (radius, face), so that the order of the search does not matter.
  void offer(const TouchedPoint& reached, std::uint32_t other) {
    if (reached.radius < least.radius || (reached.radius == least.radius && face != kNone && other < face)) {
      least = reached;
      face = other;
    }
  }
  void stop(std::uint32_t other) {
    if (dot(walls.outward_[other], ball.n) > walls.least_turn_ && walls.same_solid(from, other))
      offer(smallest_ball(ball, corners_of(walls.sites_.mesh, other)), other);
  }
};

WallEnd WallSearch::ball(std::uint32_t face, const Vec3& point) {
  Stops stops{walls_, face, {point, walls_.inward(face)}};
  // Otherwise the face that ends the ray stops the ball there by itself.
  if (walls_.ray_turn_ < walls_.least_turn_)
    if (const WallEnd end = ray(face, point);
        end.face != kNone && dot(walls_.outward_[end.face], stops.ball.n) > walls_.ray_turn_)
      stops.offer({end.thickness / 2, end.point}, end.face);
  for (const std::uint32_t before : stopped_by_)
    if (before != kNone) stops.stop(before);
  const auto stop = [](void* data, std::uint32_t other) {
    auto& by = *static_cast<Stops*>(data);
    by.stop(other);
    return by.least.radius;
  };
  for_each_near_wall(walls_.sites_, walls_.normals_, stops.ball, walls_.least_turn_, stops.least.radius,
                     {stop, &stops}, scratch_.stack);
  if (stops.face == kNone) return {};
  if (std::ranges::find(stopped_by_, stops.face) == stopped_by_.end())
    stopped_by_[next_++ % stopped_by_.size()] = stops.face;
  return {2 * stops.least.radius, stops.least.point, stops.face};
}

}  // namespace sdm::thickness

namespace sdm {
namespace thickness {
namespace {

const Sites& checked(const Mesh& mesh, const Sites& sites) {
  if (mesh.triangles.size() != sites.mesh().triangles.size())
    throw Error("surface and sites belong to different meshes: their numbers of faces differ");
  return sites;
}

class FaceWallSearch final : public map::FaceSearch {
 public:
  FaceWallSearch(const Walls& walls, ThicknessMethod method)
      : walls_(walls), method_(method), search_(walls) {}

  void start(std::span<const map::Sample> samples) override { samples_ = samples; }
  map::Value value(std::size_t i) override {
    const map::Sample& sample = samples_[i];
    if (!walls_.measures(sample.face)) return {};
    const WallEnd end = method_ == ThicknessMethod::ray ? search_.ray(sample.face, sample.point)
                                                        : search_.ball(sample.face, sample.point);
    if (end.face == kNone) return {};
    return {.closest = {.point = end.point,
                        .distance = end.thickness,
                        .site = end.face,
                        .type = SiteType::face,
                        .face = end.face},
            .vector = end.point - sample.point};
  }

 private:
  const Walls& walls_;
  ThicknessMethod method_;
  WallSearch search_;
  std::span<const map::Sample> samples_;
};

}  // namespace

ThicknessMeasure::ThicknessMeasure(const Mesh& mesh, const Sites& sites, const ThicknessOptions& options)
    : walls_(internals(checked(mesh, sites)), options.angle), method_(options.method) {
  description.measured = measured_distance(options);
  description.sign.reason = "a thickness has no sign";
  progress = options.progress;
  // Faces in the order of the tree: those that follow each other are near each other.
  groups.assign(mesh.triangles.size(), kNone);
  std::uint32_t place = 0;
  for (const std::uint32_t face : internals(sites).tree.items) groups[face] = place++;
  for (std::uint32_t& group : groups)
    if (group == kNone) group = place++;  // of ignored faces
}

std::unique_ptr<map::FaceSearch> ThicknessMeasure::search() const {
  return std::make_unique<FaceWallSearch>(walls_, method_);
}

}  // namespace thickness

MeasuredDistance measured_distance(const ThicknessOptions& options) {
  return {.kind = DistanceKind::thickness,
          .text = options.method == ThicknessMethod::ball
                      ? "wall thickness, the diameter of the largest ball in the part"
                      : "wall thickness, the length of the ray along the normal into the part",
          .settings = settings_of(options)};
}

}  // namespace sdm
