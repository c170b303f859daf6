#include "map/measures/thickness_measure.h"

#include <sdm/error.h>
#include <sdm/measure.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "closest/facing/facing_normals.h"
#include "core/parallel.h"
#include "geometry/line_triangle.h"
#include "geometry/unit_across.h"
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

Walls::Walls(const sites::SitesData& sites, ThicknessMethod method, double angle)
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
  if (method == ThicknessMethod::ball) arrange_normals();
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
  normals_.leaves.resize(leaves.size() - 1);
  constexpr std::size_t kGrain = 512;
  parallel_for(normals_.leaves.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t leaf = begin; leaf < end; ++leaf)
      normals_.leaves[leaf] =
          walls_of_leaf(std::span(sites_.tree.items).subspan(leaves[leaf], leaves[leaf + 1] - leaves[leaf]));
  });
}

LeafWalls Walls::walls_of_leaf(std::span<const std::uint32_t> faces) const {
  Vec3 mean{};
  Box normals;
  for (const std::uint32_t f : faces) {
    mean = mean + outward_[f];
    extend(normals, outward_[f]);
  }
  mean = normalized(mean);
  if (mean == Vec3{}) mean = {0, 0, 1};  // faces of two sides, or without an area
  const Vec3 across = unit_across(mean);
  const std::array axes{mean, across, cross(mean, across)};
  LeafWalls box;
  box.normals = tree::FloatBox::around(normals);
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t j = 0; j < 3; ++j) box.axis[k][j] = static_cast<float>(axes[k][j]);
    // The rounded axis, which searches use.
    const Vec3 axis{box.axis[k][0], box.axis[k][1], box.axis[k][2]};
    double least = kInfinity, most = -kInfinity;
    for (const std::uint32_t f : faces)
      for (const Vec3& corner : corners_of(sites_.mesh, f)) {
        const double along = dot(axis, sites_.frame.to_unit(corner));
        least = std::min(least, along);
        most = std::max(most, along);
      }
    constexpr double kRounding = 1e-6;
    box.lower[k] = static_cast<float>(least - kRounding);
    box.upper[k] = static_cast<float>(most + kRounding);
  }
  return box;
}

bool Walls::measures(std::uint32_t face) const {
  return !sites_.topology.ignored(face) && outward_[face] != Vec3{};
}

WallEnd WallSearch::ray(const WallStart& start) {
  const Vec3 n = walls_.inward(start.face);
  const auto leaves_by = [&](std::size_t, std::uint32_t other) {
    return dot(walls_.outward_[other], n) > kParallel && walls_.same_solid(start.face, other);
  };
  Ray ray{.origin = start.point - walls_.back_ * n, .direction = n};
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
  return {length, start.point + length * n, hit.face};
}

void WallSearch::measure(ThicknessMethod method, std::span<const WallStart> starts, std::span<WallEnd> ends) {
  if (method == ThicknessMethod::ray) {
    std::ranges::transform(starts, ends.begin(), [&](const WallStart& start) { return ray(start); });
    return;
  }
  constexpr std::size_t kPacket = BallMemory::kPacket;
  for (std::size_t i = 0; i < starts.size(); i += kPacket) {
    const std::size_t count = std::min(kPacket, starts.size() - i);
    balls(starts.subspan(i, count), ends.subspan(i, count));
  }
}

void WallSearch::balls(std::span<const WallStart> starts, std::span<WallEnd> ends) {
  for (std::size_t i = 0; i < starts.size(); ++i) {
    ends[i] = {};
    // Otherwise the face that ends the ray stops the ball there by itself.
    if (!(walls_.ray_turn_ < walls_.least_turn_)) continue;
    const WallEnd end = ray(starts[i]);
    if (end.face != kNone && dot(walls_.outward_[end.face], walls_.inward(starts[i].face)) > walls_.ray_turn_)
      ends[i] = end;
  }
  find_ball_ends(walls_, starts, known_, ends, memory_);
  // More points bound the search better, and cost more than they save from three packets on.
  constexpr std::size_t kKnown = 2 * BallMemory::kPacket;
  if (known_.size() > kKnown - BallMemory::kPacket)
    known_.erase(known_.begin(), known_.end() - (kKnown - BallMemory::kPacket));
  for (const WallEnd& end : ends)
    if (end.face != kNone) known_.push_back(end);
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

  void start(std::span<const map::Sample> samples) override {
    samples_ = samples;
    starts_.clear();
    numbers_.assign(samples.size(), kNone);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!walls_.measures(samples[i].face)) continue;
      numbers_[i] = static_cast<std::uint32_t>(starts_.size());
      starts_.push_back({samples[i].face, samples[i].point});
    }
    ends_.resize(starts_.size());
    search_.measure(method_, starts_, ends_);
  }
  map::Value value(std::size_t i) override {
    if (numbers_[i] == kNone) return {};
    const WallEnd& end = ends_[numbers_[i]];
    if (end.face == kNone) return {};
    return {.closest = {.point = end.point,
                        .distance = end.thickness,
                        .site = end.face,
                        .type = SiteType::face,
                        .face = end.face},
            .vector = end.point - samples_[i].point};
  }

 private:
  const Walls& walls_;
  ThicknessMethod method_;
  WallSearch search_;
  std::span<const map::Sample> samples_;
  std::vector<std::uint32_t> numbers_;  // of samples among those that are measured; kNone
  std::vector<WallStart> starts_;       // of these
  std::vector<WallEnd> ends_;
};

}  // namespace

ThicknessMeasure::ThicknessMeasure(const Mesh& mesh, const Sites& sites, const ThicknessOptions& options)
    : walls_(internals(checked(mesh, sites)), options.method, options.angle), method_(options.method) {
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
