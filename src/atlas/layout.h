// Where each face lies in the atlas.
#pragma once

#include <sdm/surface.h>

#include <cstdint>
#include <string>
#include <vector>

#include "atlas/packing/room.h"

namespace sdm::atlas {

/// M⁻¹ of a face: atlas coordinates (u, v) ↦ vertex 0 + (u − origin.u) edges[0] + (v − origin.v) edges[1].
struct FaceMap {
  Vec2 origin{};                ///< atlas coordinates of the face's vertex 0
  std::array<Vec3, 2> edges{};  ///< ∂p/∂u and ∂p/∂v
};

struct Layout {
  std::vector<std::vector<std::uint32_t>> charts;  ///< the faces of each
  std::vector<FaceMap> maps;
  std::vector<std::array<Vec2, 3>>
      corners;  ///< atlas coordinates; a vertex has the same ones in all faces of a chart
  double max_stretch = 1;
  double scale = 0;  ///< texels per unit length; for `uv` that at which areas agree in total
};

/// ∂p/∂u and ∂p/∂v of the affine map that takes the corners of a triangle in the atlas to its vertices: they
/// solve p1 − p0 = (u1 − u0) ∂p/∂u + (v1 − v0) ∂p/∂v, and the same for p2.
[[nodiscard]] std::array<Vec3, 2> affine_edges(const std::array<Vec2, 3>& corners,
                                               std::span<const Vec3> positions, const Triangle& triangle);

/// The same for a face that has a chart, of which a needle without area has one too: along its longest side
/// only.
[[nodiscard]] std::array<Vec3, 2> moved_edges(const std::array<Vec2, 3>& corners,
                                              std::span<const Vec3> positions, const Triangle& triangle);
/// Whether a triangle in the atlas is so thin that rounding would move the points of its affine map by more
/// than its height.
[[nodiscard]] bool is_needle(const std::array<Vec2, 3>& corners);

/// AtlasKind::charts and AtlasKind::triangles.
[[nodiscard]] Layout chart_layout(const Mesh& mesh, const AtlasOptions& options);
/// Charts of further faces for an atlas of `options`, at its scale, in free room; those of an atlas of kind
/// `uv` are made as for `charts`. Takes the room, and adds rows where necessary. Throws sdm::Error as fit()
/// does.
[[nodiscard]] Layout added_layout(const Mesh& added, const AtlasOptions& options, double scale, Room& room);
/// AtlasKind::uv. A chart is a set of faces connected by edges at which their coordinates agree. A face with
/// an area on the surface but none in the texture is a chart of its own: a sliver, which owns no texel unless
/// it is the only one at its centre; with strict_uv, it is an error.
[[nodiscard]] Layout uv_layout(const Mesh& mesh, const AtlasOptions& options);
/// Whether the corners of a face in a layout of kind `uv` are such a sliver. `uvs`: its texture coordinates.
[[nodiscard]] bool is_sliver(const std::array<Vec2, 3>& corners, const std::array<Vec2, 3>& uvs,
                             std::uint32_t columns, std::uint32_t rows);

/// "1024²", or "2048 × 1024" if the sides differ.
[[nodiscard]] inline std::string size_text(std::uint64_t columns, std::uint64_t rows) {
  return std::to_string(columns) + (rows == columns ? "²" : " × " + std::to_string(rows));
}

}  // namespace sdm::atlas
