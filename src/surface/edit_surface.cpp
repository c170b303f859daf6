#include <sdm/error.h>

#include <algorithm>
#include <utility>

#include "atlas/texel_owners.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "surface/sample_order.h"
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
      maps[f].edges = atlas::moved_edges(s.corners[f], edited.positions, to);
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
std::vector<std::uint32_t> texels_of(const SurfaceData& s, std::uint32_t face) {
  std::vector<std::uint32_t> texels;
  const atlas::TouchedRows touched(s.corners[face], 0);
  for (std::size_t i = 0; i < touched.columns.size() && touched.first_row + i < s.rows; ++i)
    for (std::size_t x = touched.columns[i][0]; x < std::min(touched.columns[i][1], s.resolution); ++x)
      if (const std::size_t texel = (touched.first_row + i) * s.resolution + x; s.map_faces[texel] == face)
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

// The change itself. Tables of texels are too large to copy for an edit, so it happens in place, and is
// undone unless it is completed.
class SurfaceData::Edit {
 public:
  /// Everything that changes is prepared: the mesh and the maps of its faces, those of added ones among them;
  /// and room is reserved for what grows, so that only the order of the samples may still fail.
  Edit(SurfaceData& surface, std::span<const std::uint32_t> removed, Mesh& mesh,
       std::vector<atlas::FaceMap>& maps, std::uint32_t rows)
      : s_(surface), removed_(removed), mesh_(mesh), maps_(maps), faces_(surface.face_charts.size()) {
    for (const std::uint32_t f : removed) {
      charts_.push_back(s_.face_charts[f]);
      corners_.push_back(s_.corners[f]);
      if (s_.face_charts[f] == kNone) continue;
      for (const std::uint32_t texel : texels_of(s_, f)) freed_.push_back({texel, f});
    }
    const auto without = s_.map_faces.begin() + s_.texels();
    without_texel_.assign(without, s_.map_faces.end());
    face_samples_ = s_.face_samples;
    face_samples_.resize(mesh.triangles.size());
    reserve_for(s_.map_faces,
                std::size_t{s_.resolution} * rows + without_texel_.size() + mesh.triangles.size() - faces_);
    reserve_for(s_.corners, mesh.triangles.size());
    reserve_for(s_.face_charts, mesh.triangles.size());
    rows_before_ = s_.rows;
    rows_ = rows;
  }
  ~Edit() {
    if (begun_ && !completed_) undo();
  }
  Edit(const Edit&) = delete;
  Edit& operator=(const Edit&) = delete;

  /// The texels of removed faces.
  [[nodiscard]] std::size_t freed_texels() const { return freed_.size(); }

  /// Charts have the numbers of their faces in the mesh.
  void run(const atlas::Layout& added) {
    begun_ = true;
    const std::uint32_t texels_before = s_.texels();
    exchange();
    s_.map_faces.resize(texels_before);
    s_.rows = rows_;
    s_.map_faces.resize(s_.texels(), kNone);
    for (const auto& [texel, face] : freed_) s_.map_faces[texel] = kNone;
    s_.corners.insert(s_.corners.end(), added.corners.begin(), added.corners.end());
    s_.face_charts.resize(s_.mesh.triangles.size(), kNone);
    for (const std::uint32_t f : removed_) {
      s_.face_charts[f] = kNone;
      s_.maps[f] = {};
      s_.corners[f] = {};
    }
    for (std::size_t c = 0; c < added.charts.size(); ++c)
      for (const std::uint32_t f : added.charts[c])
        s_.face_charts[f] = static_cast<std::uint32_t>(s_.chart_count + c);
    std::vector<std::uint8_t> removed(s_.mesh.triangles.size(), 0);
    for (const std::uint32_t f : removed_) removed[f] = 1;
    std::vector<std::uint32_t> samples =
        atlas::rasterise_added(added.charts, s_.corners, s_.resolution, s_.map_faces);
    count_samples(removed, samples);
    edit_samples(s_, removed, samples, texels_before);
    completed_ = true;
  }

 private:
  void exchange() {
    std::swap(s_.mesh, mesh_);
    std::swap(s_.maps, maps_);
    std::swap(s_.face_samples, face_samples_);
  }
  // Faces that stay keep their texels, or their own point. `added`: the texels of added faces, to which own
  // points are added.
  void count_samples(std::span<const std::uint8_t> removed, std::vector<std::uint32_t>& added) {
    for (const std::uint32_t face : removed_) s_.face_samples[face] = 0;
    for (const std::uint32_t texel : added) ++s_.face_samples[s_.map_faces[texel]];
    for (const std::uint32_t face : without_texel_)
      if (removed[face] == 0) s_.map_faces.push_back(face);
    for (auto face = static_cast<std::uint32_t>(faces_); face < s_.face_charts.size(); ++face) {
      if (s_.face_charts[face] == kNone || s_.face_samples[face] > 0) continue;
      added.push_back(static_cast<std::uint32_t>(s_.map_faces.size()));
      s_.map_faces.push_back(face);
      s_.face_samples[face] = 1;
    }
  }
  void undo() {
    exchange();
    s_.rows = rows_before_;
    s_.map_faces.resize(s_.texels());
    for (std::uint32_t& face : s_.map_faces)
      if (face >= faces_) face = kNone;
    for (const auto& [texel, face] : freed_) s_.map_faces[texel] = face;
    s_.map_faces.insert(s_.map_faces.end(), without_texel_.begin(), without_texel_.end());
    s_.corners.resize(faces_);
    s_.face_charts.resize(faces_);
    for (std::size_t i = 0; i < removed_.size(); ++i) {
      s_.face_charts[removed_[i]] = charts_[i];
      s_.corners[removed_[i]] = corners_[i];
    }
  }

  SurfaceData& s_;
  std::span<const std::uint32_t> removed_;
  Mesh& mesh_;
  std::vector<atlas::FaceMap>& maps_;
  // Before the edit.
  std::size_t faces_;
  std::uint32_t rows_before_ = 0;
  std::vector<std::uint32_t> without_texel_;         // the faces with an own point
  std::vector<std::uint32_t> charts_;                // of removed faces
  std::vector<std::array<Vec2, 3>> corners_;         // likewise
  std::vector<std::array<std::uint32_t, 2>> freed_;  // texels that removed faces own, and these faces

  std::vector<std::uint32_t> face_samples_;  // of the faces after the edit
  std::uint32_t rows_ = 0;
  bool begun_ = false, completed_ = false;
};

void SurfaceData::edit(const MeshEdit& edit) {
  intact_.require();
  Mesh edited = mesh;
  apply(edited, edit);
  const auto first_added = static_cast<std::uint32_t>(mesh.triangles.size());

  // The room is given back only if all succeeds, and made anew otherwise.
  atlas::Room room = std::exchange(room_, {});
  if (room.empty()) room = occupied_room();
  for (const std::uint32_t f : edit.removed_faces)
    if (face_charts[f] != kNone) room.remove(corners[f]);
  atlas::Layout added;
  if (!edit.added_faces.empty())
    added = atlas::added_layout(
        mesh_of_added(edited, first_added),
        {.kind = kind, .resolution = resolution, .max_stretch = stretch_limit, .gutter = gutter}, scale,
        room);
  for (std::vector<std::uint32_t>& chart : added.charts)
    for (std::uint32_t& f : chart) f += first_added;
  constexpr std::size_t kBytesPerTexel = 8;
  if (room.rows() > rows)
    require_memory(kBytesPerTexel * resolution * room.rows(), "adding rows to the atlas");
  std::vector<atlas::FaceMap> new_maps = maps;
  move_maps(*this, edited, edit, new_maps);
  new_maps.insert(new_maps.end(), added.maps.begin(), added.maps.end());
  auto new_identity = std::make_shared<Identity>();

  Edit change(*this, edit.removed_faces, edited, new_maps, room.rows());
  if (change.freed_texels() == owned_texels() && added.charts.empty())
    throw Error("no face of the edited mesh would own a texel; lay it out anew");
  change.run(added);
  room_ = std::move(room);
  chart_count += added.charts.size();
  max_stretch = std::max(max_stretch, added.max_stretch);
  identity = std::move(new_identity);
  outward_normals.forget();
  drawn_normals.forget();
}

}  // namespace sdm::surface
