// Validation of positions, for meshes and their refits.
#pragma once

#include <sdm/types.h>

#include <span>

namespace sdm::mesh {

/// Throws sdm::Error for a coordinate that is not finite or too large to compute with.
void validate_positions(std::span<const Vec3> positions);

/// The same for new positions of `count` vertices; also throws if there are more or fewer.
void validate_positions(std::span<const Vec3> positions, std::size_t count);

}  // namespace sdm::mesh
