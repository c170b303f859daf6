/// Meshes whose texture coordinates lie outside of the unit square: textures that repeat, and UDIM tiles.
///
/// Threads: the functions may be called concurrently, also with the same mesh.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sdm {

/// A unit square [u, u + 1] × [v, v + 1] of the texture plane, and the faces in it.
struct UvTile {
  std::int32_t u = 0, v = 0;
  std::vector<std::uint32_t> faces;

  /// Whether it has a UDIM number: 0 ≤ u ≤ 9 and v ≥ 0.
  [[nodiscard]] bool has_udim() const { return u >= 0 && u <= 9 && v >= 0 && v < 900; }
  /// The UDIM number, from 1001.
  [[nodiscard]] int udim() const { return 1001 + u + 10 * v; }
};

/// The tiles of a mesh.
struct UvTiles {
  std::vector<UvTile> tiles;            ///< with a face each; by v, then u
  std::vector<std::uint32_t> crossing;  ///< faces in more than one tile, which `tiles` does not contain

  /// Several tiles with UDIM numbers, and no face in more than one: each is a texture of its own.
  [[nodiscard]] bool is_udim() const;
  /// All faces are in the tile [0, 1]².
  [[nodiscard]] bool is_unit_square() const;
};

/// Faces belong to a tile if their corners are in it but for 1e-6. Throws sdm::Error if the mesh has no
/// texture coordinates, or coordinates beyond 1e6. Cost: linear.
[[nodiscard]] SDM_API UvTiles uv_tiles(const Mesh& mesh);
/// Whether the texture coordinates of all corners are the same, as programs write them that have no others.
/// Not if there are none. Cost: linear.
[[nodiscard]] SDM_API bool has_one_uv(const Mesh& mesh);

/// The faces of a tile, with texture coordinates relative to it. Vertices keep their numbers.
[[nodiscard]] SDM_API Mesh uv_tile_mesh(const Mesh& mesh, const UvTile& tile);

/// A mesh whose faces are in the unit square.
struct WrappedUvs {
  /// The faces of the mesh in their order, then the further pieces of faces that were cut; vertices that were
  /// added by cuts come last.
  Mesh mesh;
  std::vector<std::uint32_t> source_face;  ///< of each face, that of the original mesh
  std::size_t cut_faces = 0;               ///< of the original mesh
};

/// Moves all faces into the unit square, as a texture that repeats shows them. Faces in more than one tile
/// are cut along the borders: pieces of texture area below 1e-14 are omitted. Throws sdm::Error as uv_tiles()
/// does, and if the tiles in the boxes of these faces are more than 2^16 and 16 for each face of the mesh;
/// the message names the face with most of them. Cost: linear, and in the pieces.
[[nodiscard]] SDM_API WrappedUvs wrap_uvs(const Mesh& mesh, const UvTiles& tiles);

}  // namespace sdm
