// The scene `figure`: a man, 1 high, who walks on the spot in a box, facing −y.
#include <numbers>

#include "scenes/box_mesh.h"
#include "scenes/level_set.h"
#include "scenes/reduce_mesh.h"
#include "scenes/simulation.h"
#include "scenes/skeleton.h"

namespace sdm::scenes {
namespace {

enum Limb : std::size_t {
  hips,
  chest,
  head,
  left,
  right = left + 6
};  // left and right: the first of the six bones of a side
enum Part : std::size_t { thigh, shin, foot, upper_arm, forearm, hand };

Skeleton man() {
  Skeleton s;
  s.bones = {{hips, {0, 0, 0.53}}, {hips, {0, 0, 0.6}}, {chest, {0, 0.005, 0.83}}};
  const auto add = [&](std::size_t bone, const Vec3& begin, double begin_radius, const Vec3& end,
                       double end_radius) {
    s.muscles.push_back({bone, begin, end, begin_radius, end_radius});
  };
  add(chest, {0, 0.005, 0.82}, 0.032, {0, 0, 0.88}, 0.034);
  add(head, {0, 0, 0.91}, 0.052, {0, -0.008, 0.945}, 0.055);
  add(head, {0, -0.02, 0.895}, 0.036, {0, -0.025, 0.9}, 0.034);
  for (const double side : {1.0, -1.0}) {
    const auto at = [side](double x, double y, double z) { return Vec3{side * x, y, z}; };
    const std::size_t first = side > 0 ? left : right;
    const auto add_bone = [&](std::size_t parent, const Vec3& joint) { s.bones.push_back({parent, joint}); };
    add_bone(hips, at(0.05, 0, 0.5));
    add_bone(first + thigh, at(0.062, 0, 0.275));
    add_bone(first + shin, at(0.07, 0.01, 0.045));
    add_bone(chest, at(0.115, 0.005, 0.79));
    add_bone(first + upper_arm, at(0.18, 0.01, 0.645));
    add_bone(first + forearm, at(0.235, 0, 0.51));
    add(hips, at(0.035, 0, 0.515), 0.06, at(0.03, 0, 0.59), 0.055);
    add(chest, at(0.03, 0, 0.62), 0.055, at(0.05, 0.003, 0.74), 0.06);
    add(chest, at(0.06, 0.005, 0.785), 0.042, at(0.105, 0.005, 0.79), 0.036);
    add(first + thigh, at(0.05, 0, 0.48), 0.058, at(0.062, 0, 0.295), 0.038);
    add(first + shin, at(0.063, 0.004, 0.265), 0.037, at(0.07, 0.01, 0.065), 0.022);
    add(first + foot, at(0.071, 0.018, 0.028), 0.023, at(0.08, -0.075, 0.02), 0.018);
    add(first + upper_arm, at(0.122, 0.005, 0.775), 0.034, at(0.176, 0.01, 0.66), 0.027);
    add(first + forearm, at(0.183, 0.01, 0.635), 0.027, at(0.232, 0, 0.525), 0.019);
    add(first + hand, at(0.238, -0.002, 0.5), 0.02, at(0.255, -0.01, 0.445), 0.014);
  }
  return s;
}

// The rotations of all bones after `steps` double steps. Legs and arms swing in opposition, a knee bends
// while its leg moves forward, and the chest rotates against the hips.
std::vector<Matrix> stride(double steps) {
  std::vector<Matrix> rotations(right + 6, rotation_about({1, 0, 0}, 0));
  const double phase = 2 * std::numbers::pi * steps;
  rotations[hips] = rotation_about({0, 0, 1}, 0.08 * std::sin(phase));
  rotations[chest] = rotation_about({0, 0, 1}, -0.22 * std::sin(phase)) *
                     rotation_about({1, 0, 0}, 0.05 + 0.03 * std::sin(2 * phase)) *
                     rotation_about({0, 1, 0}, 0.05 * std::cos(phase));
  rotations[head] = rotation_about({0, 0, 1}, 0.14 * std::sin(phase));
  for (const std::size_t first : {std::size_t{left}, std::size_t{right}}) {
    const double at = first == left ? phase : phase + std::numbers::pi;
    const double forward = std::cos(at);  // proportional to the forward speed of the leg
    // A positive rotation about the x axis swings a hanging limb backwards.
    const auto swing = [](double angle) { return rotation_about({1, 0, 0}, angle); };
    rotations[first + thigh] = swing(-0.12 - 0.45 * std::sin(at));
    rotations[first + shin] = swing(0.2 + 0.45 * (1 + forward) * (1 + forward) / 2);
    rotations[first + foot] = swing(-0.1 + 0.15 * forward);
    rotations[first + upper_arm] = swing(0.1 + 0.5 * std::sin(at));
    rotations[first + forearm] = swing(-0.5 + 0.25 * std::sin(at));
    rotations[first + hand] = swing(-0.1);
  }
  return rotations;
}

class WalkingFigure : public Simulation {
 public:
  explicit WalkingFigure(std::vector<Scene::Body>& bodies) : WalkingFigure(bodies, man()) {}

  void advance(std::vector<Scene::Body>& bodies) override {
    ++frame_;
    walk(bodies[0].mesh.positions);
  }

 private:
  WalkingFigure(std::vector<Scene::Body>& bodies, Skeleton skeleton)
      : skeleton_(std::move(skeleton)), mesh_(skin_mesh(skeleton_)), skin_(skeleton_, mesh_.positions) {
    walk(mesh_.positions);
    bodies = {{"figure", std::move(mesh_)},
              {"box", box_mesh({{-0.5, -0.5, -0.15}, {0.5, 0.5, 1.15}}), false}};
  }

  static Mesh skin_mesh(const Skeleton& skeleton) {
    constexpr std::size_t kTriangles = 17250;  // before reduce_mesh removes coincident pairs
    return reduce_mesh(level_set([&](const Vec3& p) { return skin_distance(skeleton, p); },
                                 {{-0.4, -0.25, -0.1}, {0.4, 0.25, 1.1}}, 0.009),
                       kTriangles);
  }

  void walk(std::vector<Vec3>& positions) const {
    constexpr int kFramesPerStride = 60;
    skin_.move(pose(skeleton_, stride(static_cast<double>(frame_) / kFramesPerStride)), positions);
  }

  Skeleton skeleton_;
  Mesh mesh_;
  Skin skin_;
  int frame_ = 0;
};

}  // namespace

std::unique_ptr<Simulation> make_figure(std::vector<Scene::Body>& bodies) {
  return std::make_unique<WalkingFigure>(bodies);
}

}  // namespace sdm::scenes
