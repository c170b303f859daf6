#include "atlas_parts.h"

#include <fmt/format.h>

#include <utility>

std::vector<AtlasPart> atlas_parts(const sdm::Mesh& mesh, const sdm::AtlasOptions& options) {
  std::vector<AtlasPart> parts(1);
  if (options.kind != sdm::AtlasKind::uv || options.strict_uv) return parts;
  sdm::UvTiles tiles = sdm::uv_tiles(mesh);
  if (tiles.is_unit_square()) return parts;
  if (tiles.is_udim()) {
    parts.clear();
    for (sdm::UvTile& tile : tiles.tiles) {
      AtlasPart& part = parts.emplace_back();
      part.mesh = sdm::uv_tile_mesh(mesh, tile);
      part.udim = tile.udim();
      part.source_face = std::move(tile.faces);
    }
    return parts;
  }
  AtlasPart& part = parts.front();
  sdm::WrappedUvs wrapped = sdm::wrap_uvs(mesh, tiles);
  part.mesh = std::move(wrapped.mesh);
  part.source_face = std::move(wrapped.source_face);
  part.cut_faces = wrapped.cut_faces;
  std::string note = "texture coordinates outside of [0, 1] were wrapped";
  if (part.cut_faces > 0)
    note += fmt::format(
        "; {} faces that cross the border of the texture were cut: in face.id, their further pieces follow "
        "the {} "
        "faces of the mesh",
        part.cut_faces, mesh.triangles.size());
  part.notes.push_back(note);
  return parts;
}
