// The data of Surface.
#pragma once

#include <sdm/surface.h>

#include <cmath>
#include <vector>

#include "atlas/layout.h"
#include "atlas/packing/room.h"
#include "core/intact.h"
#include "core/lazy/kept.h"

namespace sdm::mesh {
struct SheetNormals;
}

namespace sdm::surface {

/// Identifies a surface until its next edit; refits and moves of the object do not change it. Caches of data
/// that refits preserve hold weak references to it.
struct Identity {};

/// A mesh and its layout in the atlas. Only Surface modifies it; all other code has const access.
class SurfaceData {
 public:
  /// As Surface::Surface.
  SurfaceData(Mesh mesh, const AtlasOptions& options);
  SurfaceData(Mesh mesh, const AtlasOptions& options, std::span<const std::uint8_t> atlas);
  void refit(std::span<const Vec3> positions);
  void edit(const MeshEdit& edit);
  /// Throws sdm::Error if a refit failed half-way.
  void require_intact() const { intact_.require(); }

  /// M⁻¹ of the face.
  [[nodiscard]] Vec3 to_surface(std::uint32_t face, const Vec2& uv) const {
    const atlas::FaceMap& map = maps[face];
    const Vec2 d = uv - map.origin;
    return mesh.positions[mesh.triangles[face][0]] + d[0] * map.edges[0] + d[1] * map.edges[1];
  }
  /// The texels of the atlas; samples from this index on are own points.
  [[nodiscard]] std::uint32_t texels() const { return resolution * rows; }
  [[nodiscard]] std::size_t faces_without_texel() const { return map_faces.size() - texels(); }
  [[nodiscard]] std::size_t owned_texels() const { return samples.size() - faces_without_texel(); }
  /// The sample of a face that owns no texel, as weights of its vertices 1 and 2, evenly distributed over
  /// consecutive faces: an additive sequence of the powers of 1/1.3247…, the root of x³ = x + 1, with the
  /// unit square folded into the triangle.
  [[nodiscard]] static Vec2 own_weights(std::uint32_t face) {
    double u = 0.7548776662466927 * (face + 0.5), v = 0.5698402909980532 * (face + 0.5);
    u -= std::floor(u);
    v -= std::floor(v);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    return {u, v};
  }
  [[nodiscard]] Vec3 own_point(std::uint32_t face) const {
    const auto& [a, b, c] = mesh.triangles[face];
    const auto [u, v] = own_weights(face);
    const Vec3& origin = mesh.positions[a];
    return origin + u * (mesh.positions[b] - origin) + v * (mesh.positions[c] - origin);
  }
  /// texel_point() as weights (s, t), which do not depend on positions: vertex 0 + s (vertex 1 − vertex 0) +
  /// t (vertex 2 − vertex 0). Off by at most 3e-8 of the sides.
  [[nodiscard]] Vec2 texel_weights(std::uint32_t face, std::uint32_t texel) const;
  /// The surface point of the centre of a texel that the face owns, or the own point of one that owns none.
  [[nodiscard]] Vec3 texel_point(std::uint32_t face, std::uint32_t texel) const {
    if (texel >= texels()) return own_point(face);
    const std::uint32_t column = texel % resolution, row = texel / resolution;
    return to_surface(face, {column + 0.5, row + 0.5});
  }
  /// Sets `points` to those of the samples from `first` on.
  void place_samples(std::size_t first, std::span<Vec3> points) const;
  /// As Surface::sample_points.
  [[nodiscard]] std::vector<Vec3> sample_points() const;
  /// Counts the samples of each face from the owners of the texels, which are all of map_faces, and adds the
  /// faces with a chart that own none.
  void add_own_points();

  Mesh mesh;
  AtlasKind kind;
  std::uint32_t resolution, rows, gutter;
  std::uint32_t first_rows = rows;  ///< before edits added any
  double stretch_limit;             ///< AtlasOptions::max_stretch
  std::size_t chart_count = 0, overlapping_texels = 0;
  double max_stretch = 1;
  double scale = 0;  ///< of the layout: texels per unit length
  std::vector<atlas::FaceMap> maps;
  std::vector<std::array<Vec2, 3>> corners;  ///< of each face in the atlas
  std::vector<std::uint32_t> face_charts, map_faces, samples;
  std::vector<std::uint32_t> sample_faces;  ///< samples in spatial order are scattered over map_faces
  std::vector<std::uint32_t> face_samples;  ///< how many each face has
  std::shared_ptr<const Identity> identity = std::make_shared<Identity>();
  Kept<std::vector<Vec3>> outward_normals;  ///< of the present shape: see facing::outward_normals()
  Kept<mesh::SheetNormals> drawn_normals;   ///< of the present shape: see io::shading_normals()

 private:
  class Edit;

  [[nodiscard]] atlas::Room occupied_room() const;

  atlas::Room room_;  ///< of the present layout, or empty: only edits need it
  Intact intact_{"a Surface object"};
};

}  // namespace sdm::surface

namespace sdm {

/// The data of Surface. Throws sdm::Error if a refit failed half-way. Found by argument-dependent lookup.
[[nodiscard]] inline const surface::SurfaceData& internals(const Surface& surface) {
  surface.data_->require_intact();
  return *surface.data_;
}

}  // namespace sdm
