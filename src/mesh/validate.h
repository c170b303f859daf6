// Validation of positions, for meshes and their refits.
#pragma once

#include <sdm/mesh.h>

#include <span>

namespace sdm::mesh {

/// Larger coordinates, and smaller meshes, are refused: their products leave the range of double precision.
inline constexpr double kMaxCoordinate = 1e37, kMinSize = 1e-30;

/// Throws sdm::Error for a coordinate that is not finite or too large to compute with.
void validate_positions(std::span<const Vec3> positions);

/// The same for new positions of `count` vertices; also throws if there are more or fewer.
void validate_positions(std::span<const Vec3> positions, std::size_t count);

/// The same for points that are asked about.
void validate_queries(std::span<const Vec3> points);

/// bounds(mesh). Throws as validate() does.
[[nodiscard]] Box validated_bounds(const Mesh& mesh);

/// Throws as validate() does for what an edit with valid indices and coordinates may cause.
void validate_edited(const Mesh& mesh);

}  // namespace sdm::mesh
