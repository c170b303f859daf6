// Penetration depth of thin-walled parts, nearly every point of which is as deep as any other. A repetition
// is a pose in which the bodies collide. Every result is compared with the depths of the vertices before it
// is timed, on one core and in processor time; searches know nothing of other poses.
//
//   build/dev/bench/depth [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <sdm/closest_points.h>
#include <sdm/execution.h>
#include <sdm/proximity_query.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "bodies/shape/posed_body.h"
#include "geometry/vec.h"
#include "harness.h"
#include "mesh/similarity.h"
#include "poses.h"
#include "scenes.h"
#include "scenes/reduce_mesh.h"
#include "thin_parts.h"
#include "timing.h"

namespace sdm::bench {
namespace {

/// Processor time of one run, the least of a few turns.
double processor_ms(const std::function<void()>& work) {
  constexpr int kTurns = 3;
  double least = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < kTurns; ++turn) {
    const std::clock_t begin = std::clock();
    int runs = 0;
    do {
      work();
      ++runs;
    } while (std::clock() - begin < CLOCKS_PER_SEC / 1000);
    least = std::min(least, 1000.0 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / runs);
  }
  return least;
}

constexpr double kPrecision = 1e-3;

double size_of(const std::array<Shape, 2>& shapes) {
  return std::min(diagonal(internals(shapes[0])->box()), diagonal(internals(shapes[1])->box()));
}

// The largest depth of a vertex of O2 in O1, 0 if there is none. `pose`: of O2; O1 has none.
double deepest_vertex(const Shape& o1, const Shape& o2, const Affine& pose) {
  if (!internals(o1)->solid()) return 0;
  std::vector<Vec3> points = internals(o2)->sites().mesh().positions;
  for (Vec3& p : points) p = pose(p);
  const std::vector<ClosestPoint> closest = closest_points(internals(o1)->sites(), points);
  double deepest = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (closest[i].distance > deepest && internals(o1)->inside()(points[i], closest[i]))
      deepest = closest[i].distance;
  return deepest;
}

struct Measured {
  std::vector<double> ms;
  int wrong = 0;

  void add(ProximityQuery& query, const std::array<Shape, 2>& shapes, const Affine& pose) {
    const Transform placed = mesh::Similarity{.map = pose}.transform();
    query.set_pose(1, placed);
    const BoundedLength depth = *query.penetration_depth();
    const double size =
        std::min(diagonal(internals(shapes[0])->box()), diagonal(internals(shapes[1])->box()));
    const double deepest = std::max(deepest_vertex(shapes[0], shapes[1], pose),
                                    deepest_vertex(shapes[1], shapes[0], inverse(pose)));
    wrong += deepest > depth.upper + 1e-6 * size || depth.upper - depth.lower > 1.01 * kPrecision * size ||
             depth.value < depth.lower || depth.value > depth.upper;
    ms.push_back(processor_ms([&] {
      query.set_pose(1, placed);
      (void)query.penetration_depth();
    }));
  }

  [[nodiscard]] Outcome outcome() const {
    if (wrong > 0) std::fprintf(stderr, "%d of %zu depths are wrong\n", wrong, ms.size());
    return {
        .verified = wrong == 0,
        .rows = {
            {{}, {{"median_ms", median(ms)}, {"p90_ms", quantile(ms, 0.9)}, {"most_ms", quantile(ms, 1)}}}}};
  }
};

/// A pose of O2.
using Placing = std::function<Affine(std::mt19937&)>;

Affine offset(Affine pose, std::mt19937& random, double most) {
  pose.offset = std::uniform_real_distribution<double>(0, most)(random) * random_rotation(random).rows[0];
  return pose;
}

// Turns by some degrees.
Affine slightly_turned(std::mt19937& random, double most) {
  const Vec3 axis = random_rotation(random).rows[0];
  const double half = 0.5 * std::uniform_real_distribution<double>(0, most)(random);
  const Vec3 v = std::sin(half) * axis;
  Affine pose;
  const double w = std::cos(half);
  const auto& [x, y, z] = v;
  pose.rows = {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
  return pose;
}

void measure_pair(const std::array<Mesh, 2>& meshes, int poses, std::mt19937& random, const Placing& place,
                  Measured& measured) {
  const std::array shapes{Shape(meshes[0]), Shape(meshes[1])};
  ProximityQuery query(shapes[0], shapes[1], {.depth_precision = kPrecision * size_of(shapes)});
  for (int i = 0; i < poses;) {
    const Affine pose = place(random);
    query.set_pose(1, mesh::Similarity{.map = pose}.transform());
    if (!query.colliding()) continue;
    measured.add(query, shapes, pose);
    ++i;
  }
}

Outcome of_pair(const Trial& trial, const std::array<Mesh, 2>& meshes, const Placing& place) {
  const ThreadLimit limit(trial.threads);
  std::mt19937 random(1);
  Measured measured;
  measure_pair(meshes, trial.repetitions, random, place, measured);
  return measured.outcome();
}

Affine random_pose(std::mt19937& random) {
  return offset(random_rotation(random), random, 1);
}

// Each part with each, in turn.
Outcome of_parts(const Trial& trial) {
  const ThreadLimit limit(trial.threads);
  const std::vector<ThinPart> parts = thin_parts();
  std::mt19937 random(1);
  Measured measured;
  for (int i = 0; i < trial.repetitions; ++i) {
    const std::size_t n = parts.size(), first = static_cast<std::size_t>(i) % n;
    const std::size_t second = (first + static_cast<std::size_t>(i) / n) % n;
    measure_pair({parts[first].mesh, parts[second].mesh}, 1, random, random_pose, measured);
  }
  return measured.outcome();
}

std::vector<Case> cases() {
  std::vector<Case> result;
  const auto add = [&](std::string name, std::string what, int poses,
                       std::function<Outcome(const Trial&)> run) {
    result.push_back({.name = std::move(name),
                      .description = std::move(what),
                      .run = std::move(run),
                      .repetitions = poses});
  };
  const auto nested = [](std::mt19937& random) { return offset(slightly_turned(random, 0.2), random, 0.1); };
  const auto concentric = [](std::mt19937& random) { return random_rotation(random); };
  add("cups", "a cup in another one, nearly in the same place", 40, [=](const Trial& trial) {
    return of_pair(trial, {cup(), cup()}, nested);
  });
  add("spheres", "hollow spheres with the same centre", 20, [=](const Trial& trial) {
    return of_pair(trial, {hollow_sphere(1), hollow_sphere(1)}, concentric);
  });
  add("spheres-within", "hollow spheres with the same centre, one half a wall smaller", 20,
      [=](const Trial& trial) {
        return of_pair(trial, {hollow_sphere(1), hollow_sphere(1 - 0.5 * kWall)}, concentric);
      });
  add("parts", "ten thin-walled parts, each with each", 200, of_parts);
  add("bunnies", "two bunnies of 2k triangles", 100, [](const Trial& trial) {
    const Mesh bunny = scenes::reduce_mesh(load("bunny.obj", "fit"), 2000);
    return of_pair(trial, {bunny, bunny},
                   [](std::mt19937& random) { return offset(random_rotation(random), random, 0.3); });
  });
  return result;
}

}  // namespace

Program program() {
  return {.name = "depth",
          .description = "Penetration depth of thin-walled parts",
          .repetition = "poses",
          .cases = cases()};
}

}  // namespace sdm::bench
