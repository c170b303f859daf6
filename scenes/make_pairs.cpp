// The scenes `letters` and `bunnies`: pairs of soft bodies.
#include "io/mesh/placement.h"
#include "scenes/bunny.h"
#include "scenes/letters.h"
#include "scenes/reduce_mesh.h"
#include "scenes/soft_pair.h"

namespace sdm::scenes {
namespace {

struct Start {
  std::string name;
  Mesh mesh;
  Vec3 velocity, angular_velocity;
};

std::unique_ptr<Simulation> collide(std::vector<Scene::Body>& bodies, const SoftBody::Material& material,
                                    std::array<Start, 2> starts) {
  constexpr double kGap = 0.005;
  std::array soft{SoftBody(starts[0].mesh, material, starts[0].velocity, starts[0].angular_velocity),
                  SoftBody(starts[1].mesh, material, starts[1].velocity, starts[1].angular_velocity)};
  for (Start& start : starts) bodies.push_back({std::move(start.name), std::move(start.mesh)});
  return std::make_unique<SoftPair>(std::move(soft), bodies, kGap);
}

Mesh placed(Mesh mesh, const char* steps) {
  io::place(mesh, io::parse_placement(steps));
  return mesh;
}

Mesh bunny(const std::filesystem::path& file) {
  constexpr std::size_t kTriangles = 2000;
  return placed(reduce_mesh(read_bunny(file), kTriangles), "fit,rotate:90:0:0");
}

}  // namespace

std::unique_ptr<Simulation> make_letters(std::vector<Scene::Body>& bodies) {
  // Upright, seen from −y. The G is rotated about its vertical axis.
  const Mesh e = placed(letter_e(), "rotate:90:0:0,translate:-0.75:0:0"),
             g = placed(letter_g(), "rotate:90:0:0,rotate:0:0:20,translate:0.75:0.05:0.1");
  return collide(bodies, {.cluster_radius = 0.15},
                 {Start{"E", e, {1.2, 0, 0}, {0, 0, 0.4}}, Start{"G", g, {-1.2, 0, 0}, {0, 0.5, 0}}});
}

std::unique_ptr<Simulation> make_bunnies(std::vector<Scene::Body>& bodies,
                                         const std::filesystem::path& file) {
  // Facing each other.
  const Mesh mesh = bunny(file);
  return collide(bodies, {.cluster_radius = 0.12},
                 {Start{"left", placed(mesh, "rotate:0:0:180,translate:-0.8:0:0"), {1.2, 0, 0}, {0, 0, 0}},
                  Start{"right", placed(mesh, "translate:0.8:0.05:0.05"), {-1.2, 0, 0}, {0, 0.3, 0}}});
}

}  // namespace sdm::scenes
