#include <sdm/error.h>

#include <algorithm>
#include <utility>

#include "atlas/texel_owners.h"
#include "core/geometry/vec.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "surface/edit_samples.h"
#include "surface/surface_data.h"

namespace sdm::surface {
namespace {

// The faces from `first` on, with the vertices that they use.
Mesh mesh_of_added(const Mesh& mesh, std::size_t first) {
  Mesh added;
  std::vector<std::uint32_t> vertices;
  for (std::size_t f = first; f < mesh.triangles.size(); ++f)
    vertices.insert(vertices.end(), mesh.triangles[f].begin(), mesh.triangles[f].end());
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  for (const std::uint32_t v : vertices) added.positions.push_back(mesh.positions[v]);
  for (std::size_t f = first; f < mesh.triangles.size(); ++f) {
    Triangle& t = added.triangles.emplace_back(mesh.triangles[f]);
    for (std::uint32_t& v : t)
      v = static_cast<std::uint32_t>(std::ranges::lower_bound(vertices, v) - vertices.begin());
  }
  return added;
}

// Recomputes the maps of faces that stay and whose corners have moved.
void move_maps(const SurfaceData& s, const Mesh& edited, const MeshEdit& edit,
               std::vector<atlas::FaceMap>& maps) {
  const auto follow = [&](std::size_t f) {
    const Triangle &from = s.mesh.triangles[f], &to = edited.triangles[f];
    bool moved = false;
    for (int k = 0; k < 3; ++k) moved |= s.mesh.positions[from[k]] != edited.positions[to[k]];
    if (moved && s.face_charts[f] != kNone && !is_removed(to))
      maps[f].edges = atlas::affine_edges(s.corners[f], edited.positions, to);
  };
  if (edit.moved_vertices.empty()) {
    for (const auto& reconnected : edit.reconnected_faces) follow(reconnected.face);
  } else {
    parallel_for(s.mesh.triangles.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) follow(f);
    });
  }
}

// The texels that the face owns.
std::vector<std::uint32_t> owned_texels(const SurfaceData& s, std::uint32_t face) {
  std::vector<std::uint32_t> texels;
  const atlas::TouchedRows touched(s.corners[face], 0);
  for (std::size_t i = 0; i < touched.columns.size() && touched.first_row + i < s.rows; ++i)
    for (std::size_t x = touched.columns[i][0]; x < std::min(touched.columns[i][1], s.resolution); ++x)
      if (const std::size_t texel = (touched.first_row + i) * s.resolution + x; s.texel_faces[texel] == face)
        texels.push_back(static_cast<std::uint32_t>(texel));
  return texels;
}

}  // namespace

atlas::Room SurfaceData::occupied_room() const {
  atlas::Room room(resolution, rows, gutter);
  for (std::size_t f = 0; f < corners.size(); ++f)
    if (face_charts[f] != kNone) room.add(corners[f]);
  return room;
}

void SurfaceData::edit(const MeshEdit& edit) {
  Mesh edited = mesh;
  apply(edited, edit);
  const auto first_added = static_cast<std::uint32_t>(mesh.triangles.size());
  const std::size_t face_count = edited.triangles.size();

  // Everything that may fail comes before any change. The room is given back only if all succeeds, and made
  // anew otherwise.
  atlas::Room room = std::exchange(room_, {});
  if (room.empty()) room = occupied_room();
  std::vector<std::uint8_t> removed(face_count, 0);
  std::vector<std::uint32_t> freed;
  for (const std::uint32_t f : edit.removed_faces) {
    if (face_charts[f] == kNone) continue;
    removed[f] = 1;
    room.remove(corners[f]);
    const std::vector<std::uint32_t> texels = owned_texels(*this, f);
    freed.insert(freed.end(), texels.begin(), texels.end());
  }
  atlas::Layout added;
  if (!edit.added_faces.empty())
    added = atlas::added_layout(
        mesh_of_added(edited, first_added),
        {.kind = kind, .resolution = resolution, .max_stretch = stretch_limit, .gutter = gutter}, scale,
        room);
  if (freed.size() == samples.size() && added.charts.empty())
    throw Error("no face of the edited mesh would own a texel; lay it out anew");
  constexpr std::size_t kBytesPerTexel = 8;
  if (room.rows() > rows)
    require_memory(kBytesPerTexel * resolution * room.rows(), "adding rows to the atlas");
  std::vector<atlas::FaceMap> new_maps = maps;
  move_maps(*this, edited, edit, new_maps);
  new_maps.insert(new_maps.end(), added.maps.begin(), added.maps.end());

  mesh = std::move(edited);
  maps = std::move(new_maps);
  rows = room.rows();
  room_ = std::move(room);
  for (const std::uint32_t texel : freed) texel_faces[texel] = kNone;
  texel_faces.resize(std::size_t{resolution} * rows, kNone);
  corners.insert(corners.end(), added.corners.begin(), added.corners.end());
  face_charts.resize(face_count, kNone);
  for (const std::uint32_t f : edit.removed_faces) {
    face_charts[f] = kNone;
    maps[f] = {};
    corners[f] = {};
  }
  for (std::vector<std::uint32_t>& chart : added.charts) {
    for (std::uint32_t& f : chart) {
      f += first_added;
      face_charts[f] = static_cast<std::uint32_t>(chart_count);
    }
    ++chart_count;
  }
  const std::vector<std::uint32_t> owned =
      atlas::rasterise_added(added.charts, corners, resolution, texel_faces);
  max_stretch = std::max(max_stretch, added.max_stretch);
  edit_samples(*this, removed, owned);
  identity = std::make_shared<Identity>();
}

}  // namespace sdm::surface
