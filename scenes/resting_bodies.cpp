#include "scenes/resting_bodies.h"

#include <sdm/mesh_edit.h>

#include <cmath>
#include <numbers>

#include "scenes/blocks.h"
#include "scenes/bunny.h"
#include "scenes/reduce_mesh.h"

namespace sdm::scenes {
namespace {

constexpr double kDrop = 0.01;

RigidStart fixed_blocks(const Blocks& blocks) {
  return {.shape = Shape(union_of(blocks)), .fixed = true};
}

RigidStart floor() {
  return fixed_blocks({{{-40, -40, -1}, {40, 40, 0}}});
}

RestingScene on_floor(std::string name, const Blocks& blocks, const Vec3& turn, double size) {
  RestingScene scene{.name = std::move(name), .bodies = {floor()}, .size = size};
  scene.bodies.push_back({.shape = Shape(union_of(blocks)),
                          .pose = Transform::translation({0, 0, kDrop}) * Transform::rotation(turn)});
  return scene;
}

// A torus about the z axis.
Mesh ring(double radius, double tube, std::uint32_t around, std::uint32_t across) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double r = radius + tube * std::cos(v);
      mesh.positions.push_back({r * std::cos(u), r * std::sin(u), tube * std::sin(v)});
      const std::uint32_t next_i = (i + 1) % around, next_j = (j + 1) % across;
      const std::uint32_t a = i * across + j, b = next_i * across + j, c = next_i * across + next_j,
                          d = i * across + next_j;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
    }
  return mesh;
}

}  // namespace

RestingScene post_on_floor() {
  return on_floor("post", {{{-0.5, -0.5, 0}, {0.5, 0.5, 25}}}, {0, 0, 20}, 25);
}

RestingScene comb_on_floor() {
  Blocks comb{{{0, 0, 1}, {27, 1, 2}}};
  for (int foot = 0; foot < 14; ++foot) comb.push_back({{2.0 * foot, 0, 0}, {2.0 * foot + 1, 1, 1}});
  return on_floor("comb", comb, {0.1, 0.02, 5}, 27);
}

RestingScene table_on_floor() {
  Blocks table{{{-3, -2, 2}, {3, 2, 2.3}}};
  for (const double x : {-2.8, 2.4})
    for (const double y : {-1.8, 1.4}) table.push_back({{x, y, 0}, {x + 0.4, y + 0.4, 2}});
  return on_floor("table", table, {0.3, 0.2, 10}, 6);
}

RestingScene peg_in_hole() {
  RestingScene scene{.name = "peg", .bodies = {floor()}, .size = 2};
  scene.bodies.push_back({.shape = Shape(plate_with_hole(2, 0.51, 1)), .fixed = true});
  scene.bodies.push_back(
      {.shape = Shape(union_of({{{-0.5, -0.5, 0}, {0.5, 0.5, 2}}})),
       .pose = Transform::translation({0.002, -0.003, 0.3}) * Transform::rotation({0.2, 0.15, 0.1})});
  return scene;
}

RestingScene bunnies_in_box(std::size_t bunnies, std::size_t triangles) {
  RestingScene scene{.name = "bunnies", .bodies = {}, .size = 1};
  scene.bodies.push_back(fixed_blocks({{{-2.5, -2.5, -1}, {2.5, 2.5, 0}},
                                       {{-2.5, -2.5, 0}, {-2, 2.5, 3}},
                                       {{2, -2.5, 0}, {2.5, 2.5, 3}},
                                       {{-2, -2.5, 0}, {2, -2, 3}},
                                       {{-2, 2, 0}, {2, 2.5, 3}}}));
  Mesh mesh = reduce_mesh(read_bunny(), triangles);
  transform(mesh, fit_to_unit(mesh));
  const Shape bunny(mesh);
  for (std::size_t i = 0; i < bunnies; ++i) {
    const double x = static_cast<double>(i % 3) - 1, y = static_cast<double>(i / 3 % 3) - 1;
    const auto layer = static_cast<double>(i / 9), angle = static_cast<double>(i);
    scene.bodies.push_back({.shape = bunny,
                            .pose = Transform::translation({1.25 * x, 1.25 * y, 0.9 + 1.3 * layer}) *
                                    Transform::rotation({40 * angle, 70 * angle, 110 * angle})});
  }
  return scene;
}

// Each hangs in the tube of the one above it.
RestingScene hanging_chain(std::size_t links) {
  constexpr double kRadius = 0.5, kTube = 0.12, kSlack = 0.02;
  RestingScene scene{.name = "chain", .bodies = {}, .size = 2 * (kRadius + kTube)};
  const Shape link(ring(kRadius, kTube, 24, 12));
  for (std::size_t i = 0; i < links; ++i) {
    const double z = -static_cast<double>(i) * (2 * (kRadius - kTube) - kSlack);
    scene.bodies.push_back(
        {.shape = link,
         .pose = Transform::translation({0, 0, z}) * Transform::rotation({90, 0, i % 2 == 0 ? 0.0 : 90.0}),
         .fixed = i == 0});
  }
  return scene;
}

}  // namespace sdm::scenes
