// Crowds of bodies: all near pairs in each frame, compared with the distances of the same pairs by FCL's
// dynamic AABB tree. A repetition is a frame, whose separations are compared.
//
//   build/dev/bench/bodies [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
//
// Our frame is a refit of all bodies and separations(). FCL's frame is a refit of all bodies and the
// separations; FCL uses one thread. The rigid bodies share ten shapes and are moved by poses; FCL moves all
// vertices of theirs. In the cases `world`, rigid bodies touch like those of a pile, all or one of them
// moves, and a frame is separations() and contacts(); in those named `depths`, it is penetration_depths().
// The last case is a frame of the scene `crowd`.
#include <sdm/execution.h>
#include <sdm/multi_body_query.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/stopwatch.h"
#include "fcl_crowd.h"
#include "harness.h"
#include "scenes/scene.h"
#include "timing.h"

namespace sdm::bench {
namespace {

/// A sphere of diameter 1 with 500 triangles.
Mesh ball() {
  constexpr std::uint32_t kAround = 25, kRings = 10;
  Mesh mesh;
  const auto add = [&](double polar, double angle) {
    mesh.positions.push_back({0.5 * std::sin(polar) * std::cos(angle),
                              0.5 * std::sin(polar) * std::sin(angle), 0.5 * std::cos(polar)});
  };
  add(0, 0);
  for (std::uint32_t ring = 1; ring <= kRings; ++ring)
    for (std::uint32_t i = 0; i < kAround; ++i)
      add(std::numbers::pi * ring / (kRings + 1), 2 * std::numbers::pi * i / kAround);
  add(std::numbers::pi, 0);
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  const auto at = [](std::uint32_t ring, std::uint32_t i) { return 1 + ring * kAround + i % kAround; };
  for (std::uint32_t i = 0; i < kAround; ++i) {
    mesh.triangles.push_back({0, at(0, i), at(0, i + 1)});
    for (std::uint32_t ring = 0; ring + 1 < kRings; ++ring) {
      mesh.triangles.push_back({at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)});
      mesh.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)});
    }
    mesh.triangles.push_back({last, at(kRings - 1, i + 1), at(kRings - 1, i)});
  }
  return mesh;
}

/// Balls with travelling waves on their surfaces. They drift through a cube with a volume of 5 units per
/// body, and are reflected at its walls.
class Crowd {
 public:
  explicit Crowd(std::size_t size) : side_(std::cbrt(5.0 * static_cast<double>(size))), positions_(size) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto vector = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
    for (std::size_t i = 0; i < size; ++i)
      movers_.push_back({side_ * vector(), 0.02 * vector(), 6.0 * vector(), 3 * uniform(random)});
  }

  std::span<const std::vector<Vec3>> at(int frame) {
    for (std::size_t i = 0; i < movers_.size(); ++i) {
      const Mover& m = movers_[i];
      const Vec3 centre = reflected(m.start + static_cast<double>(frame) * m.velocity);
      positions_[i].clear();
      for (const Vec3& p : ball_.positions)
        positions_[i].push_back(centre + (1 + 0.2 * std::sin(dot(m.wave, p) + m.phase + 0.1 * frame)) * p);
    }
    return positions_;
  }
  std::vector<Mesh> meshes() {
    std::vector<Mesh> result;
    for (const std::vector<Vec3>& positions : at(0)) result.push_back({positions, ball_.triangles, {}});
    return result;
  }
  /// The bodies of frame 0, each about the origin.
  [[nodiscard]] std::vector<Mesh> waves() const {
    std::vector<Mesh> result;
    for (const Mover& m : movers_) {
      Mesh mesh = ball_;
      for (Vec3& p : mesh.positions) p = (1 + 0.2 * std::sin(dot(m.wave, p) + m.phase)) * p;
      result.push_back(std::move(mesh));
    }
    return result;
  }
  /// Where the bodies are, turning about their axes.
  [[nodiscard]] std::vector<Transform> poses(int frame) const {
    std::vector<Transform> result;
    for (const Mover& m : movers_) {
      const double half = 0.02 * frame + m.phase;
      const Vec3 axis = std::sin(half) * normalized(m.wave);
      result.push_back(Transform::translation(reflected(m.start + static_cast<double>(frame) * m.velocity)) *
                       Transform::quaternion({std::cos(half), axis[0], axis[1], axis[2]}));
    }
    return result;
  }

 private:
  struct Mover {
    Vec3 start, velocity, wave;
    double phase;
  };
  [[nodiscard]] Vec3 reflected(Vec3 p) const {
    for (double& x : p) x = std::abs(std::remainder(x, 2 * side_));
    return p;
  }

  Mesh ball_ = ball();
  double side_;
  std::vector<Mover> movers_;
  std::vector<std::vector<Vec3>> positions_;
};

// FCL rounds moved vertices differently, and returns -1 for surfaces that intersect.
bool agree(std::span<const PairSeparation> ours, std::span<const FclCrowd::Pair> fcl, double max_distance) {
  constexpr double kTolerance = 1e-6;
  auto pair = ours.begin();
  for (const FclCrowd::Pair& theirs : fcl) {
    const bool same = pair != ours.end() && pair->first == theirs.first && pair->second == theirs.second;
    if (!same && theirs.distance < max_distance - kTolerance) return false;
    if (!same) continue;
    if (std::abs(pair->separation.value - std::max(0.0, theirs.distance)) > kTolerance) return false;
    ++pair;
  }
  return pair == ours.end();
}

/// Times of our frames and FCL's, and what was found.
class Frames {
 public:
  explicit Frames(const Trial& trial, double max_distance) : trial_(trial), max_distance_(max_distance) {}

  /// Frames before the first one warm up, and are not counted.
  static constexpr int kWarmUp = 3;

  template <class Ours, class Theirs>
  void add(int frame, const Ours& ours, const Theirs& theirs) {
    Stopwatch watch;
    MultiBodyQuery& query = ours();
    const double our_time = watch.lap();
    const std::span<const FclCrowd::Pair> expected = theirs();
    const double fcl_time = watch.lap();
    if (frame < 0) return;
    ours_ms_.push_back(our_time);
    fcl_ms_.push_back(fcl_time);
    const std::span<const PairSeparation> found = query.separations(max_distance_);
    verified_ &= agree(found, expected, max_distance_);
    candidates_ += query.candidate_pairs();
    pairs_ += found.size();
    colliding_ += query.colliding().size();
  }

  [[nodiscard]] Outcome outcome() const {
    const auto per_frame = [&](std::size_t count) { return static_cast<double>(count) / trial_.repetitions; };
    const auto row = [&](const char* name, const std::vector<double>& times) {
      return Row{name,
                 {{"mean_ms", mean(times)},
                  {"p99_ms", quantile(times, 0.99)},
                  {"fcl_over_this", mean(fcl_ms_) / mean(times)}}};
    };
    return {.verified = verified_,
            .rows = {row("ours", ours_ms_), row("fcl", fcl_ms_)},
            .counts = {{"candidate_pairs", per_frame(candidates_)},
                       {"pairs", per_frame(pairs_)},
                       {"colliding", per_frame(colliding_)}}};
  }

 private:
  const Trial& trial_;
  double max_distance_;
  std::vector<double> ours_ms_, fcl_ms_;
  std::size_t candidates_ = 0, pairs_ = 0, colliding_ = 0;
  bool verified_ = true;
};

Outcome deforming(const Trial& trial, std::size_t size, double max_distance) {
  const ThreadLimit limit(trial.threads);
  Crowd crowd(size);
  const std::vector<Mesh> meshes = crowd.meshes();
  MultiBodyQuery query(meshes);
  FclCrowd fcl(meshes);
  std::vector<std::span<const Vec3>> positions(size);
  Frames frames(trial, max_distance);
  for (int frame = -Frames::kWarmUp; frame < trial.repetitions; ++frame) {
    const std::span<const std::vector<Vec3>> moved = crowd.at(frame);
    std::ranges::copy(moved, positions.begin());
    frames.add(
        frame,
        [&]() -> MultiBodyQuery& {
          query.refit(positions);
          (void)query.separations(max_distance);
          return query;
        },
        [&] {
          fcl.refit(moved);
          return fcl.distances(max_distance);
        });
  }
  return frames.outcome();
}

// Bodies of ten shapes that turn as they drift.
Outcome rigid(const Trial& trial, std::size_t size, double max_distance) {
  constexpr std::size_t kShapes = 10;
  const ThreadLimit limit(trial.threads);
  Crowd crowd(size);
  const std::vector<Mesh> shape_meshes = Crowd(kShapes).waves();
  std::vector<Shape> shapes, bodies;
  std::vector<Mesh> meshes;
  for (const Mesh& mesh : shape_meshes) shapes.emplace_back(mesh);
  for (std::size_t b = 0; b < size; ++b) {
    bodies.push_back(shapes[b % kShapes]);
    meshes.push_back(shape_meshes[b % kShapes]);
  }
  MultiBodyQuery query(std::move(bodies));
  FclCrowd fcl(meshes);
  Frames frames(trial, max_distance);
  for (int frame = -Frames::kWarmUp; frame < trial.repetitions; ++frame) {
    const std::vector<Transform> poses = crowd.poses(frame);
    frames.add(
        frame,
        [&]() -> MultiBodyQuery& {
          query.set_poses(poses);
          (void)query.separations(max_distance);
          return query;
        },
        [&] {
          fcl.move(poses);
          return fcl.distances(max_distance);
        });
  }
  return frames.outcome();
}

/// Bodies of ten shapes on a lattice, each turned by some angle, which shake so that neighbours touch.
class Pile {
 public:
  explicit Pile(std::size_t size) : side_(static_cast<std::size_t>(std::cbrt(size) + 0.5)) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Shape> shapes;
    for (const Mesh& mesh : Crowd(kShapes).waves()) shapes.emplace_back(mesh);
    for (std::size_t b = 0; b < size; ++b) {
      bodies_.push_back(shapes[b % kShapes]);
      turns_.push_back({180 * uniform(random), 180 * uniform(random), 180 * uniform(random)});
    }
  }
  [[nodiscard]] const std::vector<Shape>& bodies() const { return bodies_; }
  [[nodiscard]] Transform pose(std::size_t body, int frame) const {
    constexpr double kApart = 1.06, kShake = 0.01;  // widths of a ball without waves
    const auto at = [](std::size_t i) { return kApart * static_cast<double>(i); };
    const double phase = static_cast<double>(body) + 0.5 * frame;
    return Transform::translation({at(body % side_) + kShake * std::sin(phase), at(body / side_ % side_),
                                   at(body / side_ / side_) + kShake * std::cos(phase)}) *
           Transform::rotation(turns_[body] + Vec3{0.1 * frame, 0, 0});
  }

 private:
  static constexpr std::size_t kShapes = 10;

  std::size_t side_;
  std::vector<Shape> bodies_;
  std::vector<Vec3> turns_;
};

// Frames of a pile of which all bodies move, or one: what is computed again equals a new world's answers.
Outcome pile(const Trial& trial, std::size_t size, bool all, bool depths) {
  constexpr double kNear = 0.02;
  const ThreadLimit limit(trial.threads);
  const Pile pile(size);
  const ProximityOptions options{.contact_margin = 0.001};
  MultiBodyQuery query(pile.bodies(), options);
  std::vector<Transform> poses;
  for (std::size_t b = 0; b < size; ++b) poses.push_back(pile.pose(b, 0));
  query.set_poses(poses);
  const auto answer = [&](MultiBodyQuery& asked) {
    if (depths) return std::array{asked.penetration_depths().size(), std::size_t{0}};
    std::size_t contacts = 0;
    for (const PairContacts& pair : asked.contacts()) contacts += pair.contacts.size();
    return std::array{asked.separations(kNear).size(), contacts};
  };
  std::array<std::size_t, 2> found = answer(query);
  std::vector<double> times;
  for (int frame = 1; frame <= trial.repetitions; ++frame) {
    const std::size_t mover = (7919 * static_cast<std::size_t>(frame)) % size;
    for (std::size_t b = 0; b < size; ++b)
      if (all || b == mover) poses[b] = pile.pose(b, frame);
    Stopwatch watch;
    if (all)
      query.set_poses(poses);
    else
      query.set_pose(mover, poses[mover]);
    found = answer(query);
    times.push_back(watch.lap());
  }
  MultiBodyQuery anew(pile.bodies(), options);
  anew.set_poses(poses);
  const bool verified = answer(anew) == found;
  return {
      .verified = verified,
      .rows = {{"frame",
                {{"mean_ms", mean(times)}, {"median_ms", median(times)}, {"p99_ms", quantile(times, 0.99)}}}},
      .counts = {{"colliding", static_cast<double>(query.colliding().size())},
                 {depths ? "depths" : "pairs", static_cast<double>(found[0])},
                 {"contacts", static_cast<double>(found[1])}}};
}

// The scene `crowd`: each of its agents steers by its map to all others.
Outcome agents(const Trial& trial) {
  const ThreadLimit limit(trial.threads);
  scenes::Scene scene(scenes::SceneKind::crowd);
  std::vector<Mesh> meshes;
  for (const scenes::Scene::Body& body : scene.bodies())
    if (body.moves) meshes.push_back(body.mesh);
  MultiBodyQuery query(meshes);
  std::vector<std::span<const Vec3>> positions(meshes.size());
  std::vector<double> times;
  std::size_t pairs = 0, colliding = 0;
  for (int frame = 0; frame < trial.repetitions; ++frame) {
    Stopwatch watch;
    scene.advance();
    times.push_back(watch.lap());
    for (std::size_t b = 0; b < positions.size(); ++b) positions[b] = scene.bodies()[b].mesh.positions;
    query.refit(positions);
    pairs += query.separations(0.5).size();
    colliding += query.colliding().size();
  }
  return {
      .verified = colliding == 0,
      .rows = {{"frame",
                {{"mean_ms", mean(times)}, {"median_ms", median(times)}, {"p99_ms", quantile(times, 0.99)}}}},
      .counts = {{"pairs", static_cast<double>(pairs) / trial.repetitions}}};
}

std::vector<Case> cases() {
  std::vector<Case> result;
  const auto add = [&](const char* name, std::size_t size, const std::string& what, int repetitions,
                       std::function<Outcome(const Trial&)> run) {
    const std::string count = std::to_string(size);
    result.push_back({.name = name + ("-" + count),
                      .description = count + " bodies of 500 triangles, " + what,
                      .run = std::move(run),
                      .repetitions = repetitions,
                      .threads = 0});
  };
  constexpr double kNear = 0.5;
  for (const std::size_t size : {5u, 10u, 20u, 40u, 100u})
    add("near", size, "pairs nearer than half a body's width", 100,
        [=](const Trial& trial) { return deforming(trial, size, kNear); });
  for (const std::size_t size : {5u, 10u, 20u, 40u})
    add("all", size, "all pairs", 100,
        [=](const Trial& trial) { return deforming(trial, size, std::numeric_limits<double>::infinity()); });
  for (const std::size_t size : {100u, 1000u, 10000u})
    add("rigid", size, "rigid, pairs nearer than half a body's width", size < 10000 ? 50 : 5,
        [=](const Trial& trial) { return rigid(trial, size, kNear); });
  for (const std::size_t size : {1000u, 10000u}) {
    const int repetitions = size < 10000 ? 100 : 20;
    add("world", size, "that touch: separations and contacts, all move", size < 10000 ? 50 : 5,
        [=](const Trial& trial) { return pile(trial, size, true, false); });
    add("world-one", size, "that touch: separations and contacts, one moves", repetitions,
        [=](const Trial& trial) { return pile(trial, size, false, false); });
  }
  add("world-depths", 1000, "that touch: depths, all move", 50,
      [=](const Trial& trial) { return pile(trial, 1000, true, true); });
  result.push_back({.name = "agents-100",
                    .description = "the scene `crowd`: maps of 100 agents to each other, and their steps",
                    .run = agents,
                    .repetitions = 900,
                    .threads = 0});
  return result;
}

}  // namespace

Program program() {
  return {.name = "bodies",
          .description = "Proximity of many deforming bodies against FCL on one thread",
          .repetition = "frames",
          .cases = cases()};
}

}  // namespace sdm::bench
