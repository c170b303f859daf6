// Bodies that fall by little and come to rest, as hard cases for contacts.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scenes/rigid_world.h"

namespace sdm::scenes {

/// What falls, and what it is to rest on.
struct RestingScene {
  std::string name;
  std::vector<RigidStart> bodies;
  double size = 1;  ///< the largest side of the smallest moving body
};

/// A post of 1 × 1 × 25, upright: tilted by little, it would rock for minutes, and lose half a percent of the
/// energy of its motion at each impact.
[[nodiscard]] RestingScene post_on_floor();
/// A comb with 14 feet.
[[nodiscard]] RestingScene comb_on_floor();
[[nodiscard]] RestingScene table_on_floor();
/// A peg of 1 × 1 × 2 in a hole with 0.01 on each side, a little tilted.
[[nodiscard]] RestingScene peg_in_hole();
/// Bunnies of so many triangles above each other, which fall into a box.
[[nodiscard]] RestingScene bunnies_in_box(std::size_t bunnies, std::size_t triangles);
/// Links of a chain that hangs from the first one.
[[nodiscard]] RestingScene hanging_chain(std::size_t links);

}  // namespace sdm::scenes
