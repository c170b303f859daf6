// Placements of one mesh relative to another.
#pragma once

#include <random>
#include <vector>

#include "proximity/exact/mesh_pair.h"

namespace sdm::bench {

/// A rotation about the origin, all equally likely.
[[nodiscard]] Affine random_rotation(std::mt19937& random);

/// How two meshes may stand.
enum class Stand { far, near, touching, penetrating, deep };
inline constexpr Stand kStands[] = {Stand::far, Stand::near, Stand::touching, Stand::penetrating,
                                    Stand::deep};

/// Rigid poses of O2, turned at random and put on a random side of O1: half of both meshes' size away; a
/// hundredth; as close as doubles allow; a twentieth inside from there; and centre on centre. The stands take
/// turns.
[[nodiscard]] std::vector<Affine> random_poses(const Sites& o1, const Sites& o2, std::size_t count,
                                               std::mt19937& random);

}  // namespace sdm::bench
