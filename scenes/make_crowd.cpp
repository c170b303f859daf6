// The scene `crowd`: agents that cross a hilly ground, each to the opposite side, and steer by the distance
// maps of their bodies to all others, as in A. Sud, E. Andersen, S. Curtis, M. Lin and D. Manocha, "Real-time
// path planning for virtual agents in dynamic environments" (2007) by Voronoi diagrams of the ground.
#include <sdm/multi_body_query.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/parallel.h"
#include "scenes/simulation.h"

namespace sdm::scenes {
namespace {

constexpr std::size_t kAgents = 100;
constexpr double kRadius = 12;             // of the circle on which they start, in metres
constexpr double kSpeed = 1.4;             // that they prefer
constexpr double kFastest = 2, kTurn = 3;  // per second
constexpr double kSight = 1;               // they react to others up to this distance
constexpr double kNear = 0.3;              // separations up to this limit how far they move in a step
constexpr std::uint32_t kResolution = 32;  // of their maps

double height_at(double x, double y) {
  return 0.8 * std::sin(0.25 * x) * std::cos(0.2 * y) + 0.3 * std::sin(0.5 * x + 0.3 * y);
}

Mesh ground() {
  constexpr int kSide = 64;
  constexpr double kCell = 0.5;
  Mesh mesh;
  for (int j = 0; j <= kSide; ++j)
    for (int i = 0; i <= kSide; ++i) {
      const double x = kCell * (i - kSide / 2), y = kCell * (j - kSide / 2);
      mesh.positions.push_back({x, y, height_at(x, y)});
    }
  for (std::uint32_t j = 0; j < kSide; ++j)
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const std::uint32_t a = j * (kSide + 1) + i, c = a + kSide + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, c + 1}, {a, c + 1, c}});
    }
  return mesh;
}

// A standing figure that faces x, wider from side to side: rings of an ellipse at these heights and radii.
Mesh figure() {
  constexpr std::uint32_t kAround = 16;
  constexpr std::array<std::array<double, 2>, 15> kProfile{{{0.00, 0.12},
                                                            {0.05, 0.17},
                                                            {0.25, 0.16},
                                                            {0.50, 0.17},
                                                            {0.75, 0.19},
                                                            {0.90, 0.20},
                                                            {1.05, 0.18},
                                                            {1.20, 0.20},
                                                            {1.35, 0.24},
                                                            {1.44, 0.22},
                                                            {1.48, 0.10},
                                                            {1.54, 0.10},
                                                            {1.60, 0.13},
                                                            {1.68, 0.12},
                                                            {1.73, 0.07}}};
  constexpr double kDepth = 0.6;  // relative to the width
  Mesh mesh;
  for (const auto& [z, radius] : kProfile)
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAround;
      mesh.positions.push_back({kDepth * radius * std::cos(angle), radius * std::sin(angle), z});
    }
  const auto rings = static_cast<std::uint32_t>(kProfile.size());
  for (std::uint32_t r = 0; r + 1 < rings; ++r)
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const std::uint32_t next = (k + 1) % kAround, a = r * kAround + k, b = r * kAround + next;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, b + kAround}, {a, b + kAround, a + kAround}});
    }
  const auto soles = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back({0, 0, 0});
  mesh.positions.push_back({0, 0, 1.75});
  for (std::uint32_t k = 0; k < kAround; ++k) {
    const std::uint32_t next = (k + 1) % kAround, top = (rings - 1) * kAround;
    mesh.triangles.insert(mesh.triangles.end(), {{soles, next, k}, {soles + 1, top + k, top + next}});
  }
  return mesh;
}

struct Agent {
  Vec3 place{}, velocity{}, goal{};  // of the soles; z is the height of the ground
  double heading = 0;

  [[nodiscard]] Transform pose() const {
    return Transform::translation(place) *
           Transform::quaternion({std::cos(heading / 2), 0, 0, std::sin(heading / 2)});
  }
};

class Crowd : public Simulation {
 public:
  explicit Crowd(std::vector<Scene::Body>& bodies)
      : figure_(figure()),
        shape_(figure_, {.resolution = kResolution}),
        query_(std::vector<Shape>(kAgents, shape_)) {
    for (std::size_t i = 0; i < kAgents; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kAgents;
      Agent& agent = agents_.emplace_back();
      agent.place = on_ground(kRadius * std::cos(angle), kRadius * std::sin(angle));
      // Not all through the same point.
      const double to = angle + std::numbers::pi + 0.7 * std::sin(2.4 * static_cast<double>(i));
      agent.goal = on_ground(kRadius * std::cos(to), kRadius * std::sin(to));
      agent.heading = angle + std::numbers::pi;
      bodies.push_back({"agent" + std::string(i < 10 ? "0" : "") + std::to_string(i), figure_});
    }
    bodies.push_back({"ground", ground(), false});
    for (const Vec3& p : figure_.positions) widest_ = std::max(widest_, std::hypot(p[0], p[1]));
    poses_.resize(kAgents);
    maps_.resize(kAgents);
    next_.resize(kAgents);
    show(bodies);
  }

  void advance(std::vector<Scene::Body>& bodies) override {
    for (std::size_t i = 0; i < kAgents; ++i) poses_[i] = agents_[i].pose();
    query_.set_poses(poses_);
    separations_.assign(kAgents, kNear);
    for (const PairSeparation& pair : query_.separations(kNear))
      for (const std::uint32_t i : {pair.first, pair.second})
        separations_[i] = std::min(separations_[i], pair.separation.value);
    parallel_for(kAgents, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        query_.nearest_map(i, kSight, maps_[i]);
        next_[i] = advanced(agents_[i], maps_[i], separations_[i]);
      }
    });
    agents_ = next_;
    show(bodies);
  }

 private:
  static Vec3 on_ground(double x, double y) { return {x, y, height_at(x, y)}; }

  // The agent after a time step, given the map of its body to the others and its separation from them.
  [[nodiscard]] Agent advanced(const Agent& agent, const NearestMap& nearest, double separation) const {
    constexpr double kRelaxation = 0.4, kPush = 25, kPass = 25, kTight = 0.03, kStepBack = 0.5;
    Vec3 way = agent.goal - agent.place;
    way[2] = 0;
    const double left = norm(way);
    const Vec3 wanted = std::min(kSpeed, left) / std::max(left, 1e-9) * way;
    const Reaction others = reaction(agent, nearest);
    Vec3 velocity = agent.velocity + kTimeStep * ((1 / kRelaxation) * (wanted - agent.velocity) +
                                                  kPush * others.away + kPass * others.right);
    if (separation < kTight) velocity = kStepBack / std::max(norm(others.away), 1e-9) * others.away;
    velocity[2] = 0;
    if (const double speed = norm(velocity); speed > kFastest) velocity = (kFastest / speed) * velocity;

    // Of two bodies that are d apart, neither touches the other while both move by less than d/2.
    Agent next = agent;
    const double turn = turn_to(agent.heading, velocity);
    const Vec3 step =
        on_ground(agent.place[0] + kTimeStep * velocity[0], agent.place[1] + kTimeStep * velocity[1]) -
        agent.place;
    const double free = 0.45 * separation, motion = kSteep * norm(step) + widest_ * std::abs(turn);
    const double part = motion > free ? free / motion : 1;
    next.place = on_ground(agent.place[0] + part * step[0], agent.place[1] + part * step[1]);
    next.heading = agent.heading + part * turn;
    next.velocity = (part / kTimeStep) * Vec3{step[0], step[1], 0};
    return next;
  }

  // Away from what is close or comes closer, and to the right of it: the means over the samples of the body.
  struct Reaction {
    Vec3 away{}, right{};
  };
  [[nodiscard]] Reaction reaction(const Agent& agent, const NearestMap& nearest) const {
    Reaction sum;
    const std::span<const std::uint32_t> texels = query_.surface(0).sample_texels();
    for (const std::uint32_t texel : texels) {
      if (nearest.body[texel] == kNone) continue;
      const auto& v = nearest.map.vector[texel];
      const double across = std::hypot(v[0], v[1]), distance = std::abs(nearest.map.distance[texel]);
      if (!(across > 0)) continue;
      const Vec3 away{-v[0] / across, -v[1] / across, 0}, right{-away[1], away[0], 0};
      const double closing =
          std::max(0.0, -dot(agent.velocity - agents_[nearest.body[texel]].velocity, away));
      sum.away += (3 * std::exp(-distance / 0.12) + 0.3 * closing * std::exp(-distance / 0.4)) * away;
      sum.right += (std::exp(-distance / 0.2) + 0.3 * closing * std::exp(-distance / 0.8)) * right;
    }
    const double weight = 1 / static_cast<double>(texels.size());
    return {weight * sum.away, weight * sum.right};
  }

  // By how much a step turns the agent towards the direction in which it moves.
  static double turn_to(double heading, const Vec3& velocity) {
    if (norm(velocity) < 0.1) return 0;
    const double angle = std::remainder(std::atan2(velocity[1], velocity[0]) - heading, 2 * std::numbers::pi);
    return std::clamp(angle, -kTimeStep * kTurn, kTimeStep * kTurn);
  }

  void show(std::vector<Scene::Body>& bodies) const {
    for (std::size_t i = 0; i < kAgents; ++i) {
      const Agent& agent = agents_[i];
      const double c = std::cos(agent.heading), s = std::sin(agent.heading);
      std::ranges::transform(figure_.positions, bodies[i].mesh.positions.begin(), [&](const Vec3& p) {
        return agent.place + Vec3{c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
      });
    }
  }

  // The ground is nowhere steeper than 0.21: a step that is scaled down moves along a path that is at most
  // this much longer than the step.
  static constexpr double kSteep = 1.1;

  Mesh figure_;
  double widest_ = 0;  // distance of a point of the figure from its axis
  Shape shape_;
  MultiBodyQuery query_;
  std::vector<double> separations_;
  std::vector<Agent> agents_, next_;
  std::vector<Transform> poses_;
  std::vector<NearestMap> maps_;
};

}  // namespace

std::unique_ptr<Simulation> make_crowd(std::vector<Scene::Body>& bodies) {
  return std::make_unique<Crowd>(bodies);
}

}  // namespace sdm::scenes
