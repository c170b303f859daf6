#include <sdm/bake.h>
#include <sdm/error.h>
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "baking/geometry/mikktspace/frames.h"
#include "baking/geometry/texel_walk.h"
#include "core/memory.h"
#include "geometry/vec.h"
#include "map/transfer/corner_normals.h"

namespace sdm {
namespace {

using baking::MikkCorner;

/// The place of a corner in the image, from 0 to 1, v up. Faces of a chart agree on it up to rounding: it is
/// rounded to 1/256 of a texel, so that MikkTSpace joins them.
std::array<float, 2> uv_of(const Surface& surface, const Vec2& place) {
  constexpr double kStep = 256;
  const auto rounded = [](double texels) { return std::round(kStep * texels) / kStep; };
  return {static_cast<float>(rounded(place[0]) / surface.resolution()),
          static_cast<float>(1 - rounded(place[1]) / surface.rows())};
}

std::vector<std::array<MikkCorner, 3>> mikk_triangles(const Surface& surface,
                                                      const map::CornerNormals& normals,
                                                      std::span<const std::uint32_t> faces) {
  const Mesh& mesh = surface.mesh();
  const Box box = bounds(mesh);
  const Vec3 centre = 0.5 * (box.lower + box.upper);  // single precision resolves what is near it
  std::vector<std::array<MikkCorner, 3>> triangles(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const std::uint32_t face = faces[i];
    const auto places =
        surface.face_charts()[face] == kNone ? std::array<Vec2, 3>{} : surface.atlas_corners(face);
    for (int k = 0; k < 3; ++k) {
      MikkCorner& corner = triangles[i][k];
      const Vec3 p = mesh.positions[mesh.triangles[face][k]] - centre,
                 n = normalized(normals.of_corner(face, k));
      for (int c = 0; c < 3; ++c) {
        corner.position[c] = static_cast<float>(p[c]);
        corner.normal[c] = static_cast<float>(n[c]);
      }
      corner.uv = uv_of(surface, places[k]);
    }
  }
  return triangles;
}

/// A unit vector across another one, for corners whose faces have no place in the atlas.
Vec3 any_tangent(const Vec3& n) {
  return normalized(std::abs(n[0]) < std::abs(n[1]) ? cross(n, {1, 0, 0}) : cross(n, {0, 1, 0}));
}

std::array<float, 4> unit_tangent(const MikkCorner& corner) {
  const auto& [x, y, z, sign] = corner.tangent;
  Vec3 t{x, y, z};
  if (t == Vec3{} || !finite(t)) t = any_tangent({corner.normal[0], corner.normal[1], corner.normal[2]});
  t = normalized(t);
  return {static_cast<float>(t[0]), static_cast<float>(t[1]), static_cast<float>(t[2]),
          sign < 0 ? -1.f : 1.f};
}

/// The rows of corners that have the same tangent at the same vertex.
MeshAttribute joined_rows(const Mesh& mesh, std::span<const std::uint32_t> faces,
                          std::span<const std::array<MikkCorner, 3>> triangles) {
  struct Row {
    std::array<std::uint32_t, 5> key;  ///< the vertex, and the bits of the tangent
    std::uint32_t corner;              ///< 3 · index of the face + corner
  };
  std::vector<Row> rows;
  rows.reserve(3 * faces.size());
  for (std::uint32_t i = 0; i < faces.size(); ++i)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto bits = std::bit_cast<std::array<std::uint32_t, 4>>(unit_tangent(triangles[i][k]));
      rows.push_back({{mesh.triangles[faces[i]][k], bits[0], bits[1], bits[2], bits[3]}, 3 * i + k});
    }
  std::ranges::sort(rows, {}, [](const Row& row) { return std::pair(row.key, row.corner); });
  MeshAttribute result{.name = "tangent", .components = 4, .values = {}, .rows = nullptr};
  std::vector<Triangle> of_faces(mesh.triangles.size(), {kNone, kNone, kNone});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i == 0 || rows[i].key != rows[i - 1].key)
      for (int c = 1; c < 5; ++c) result.values.push_back(std::bit_cast<float>(rows[i].key[c]));
    of_faces[faces[rows[i].corner / 3]][rows[i].corner % 3] =
        static_cast<std::uint32_t>(result.values.size() / 4 - 1);
  }
  result.rows = std::make_shared<const std::vector<Triangle>>(std::move(of_faces));
  return result;
}

void require_tangents(const Mesh& mesh, const MeshAttribute& tangents) {
  if (tangents.components != 4 || !tangents.rows || tangents.rows->size() != mesh.triangles.size())
    throw Error(
        "the tangents of the surface must have four components, and a row for each corner of its faces");
  const std::size_t count = tangents.values.size() / 4;
  for (const Triangle& of_face : *tangents.rows)
    for (const std::uint32_t row : of_face)
      if (row != kNone && row >= count)
        throw Error("the tangents of the surface have " + std::to_string(count) +
                    " rows, but a corner refers to row " + std::to_string(row));
}

/// The frame at a point of a face, with the normal and the tangent as they are interpolated.
struct Frame {
  Vec3 t{}, b{}, n{};

  Frame(const MeshAttribute& tangents, const baking::TexelPlaces::Place& place, const Vec3& normal)
      : n(normal) {
    double sign = 1;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t row = (*tangents.rows)[place.face][k];
      if (row == kNone) continue;
      const float* const tangent = tangents.values.data() + 4 * std::size_t{row};
      t += place.weights[k] * Vec3{tangent[0], tangent[1], tangent[2]};
      sign = tangent[3] < 0 ? -1 : 1;  // that of all three
    }
    if (cross(n, t) == Vec3{}) t = any_tangent(n);
    b = sign * cross(n, t);
  }
  /// x, y, z with m ∥ x t + y b + z n: by Cramer's rule, of which only the sign of the determinant matters.
  [[nodiscard]] Vec3 coordinates(const Vec3& m) const {
    const Vec3 across = cross(b, n);
    const double sign = dot(t, across) < 0 ? -1 : 1;
    return normalized(sign * Vec3{dot(m, across), dot(m, cross(n, t)), dot(m, cross(t, b))});
  }
};

}  // namespace

bool has_tangents() {
  return baking::has_mikktspace();
}

MeshAttribute tangents(const Surface& surface, const MeshAttribute& normals) try {
  const Mesh& mesh = surface.mesh();
  const map::CornerNormals corners(mesh, normals, "the surface");
  std::vector<std::uint32_t> faces;
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face)
    if (!is_removed(mesh.triangles[face])) faces.push_back(face);
  std::vector<std::array<MikkCorner, 3>> triangles = mikk_triangles(surface, corners, faces);
  baking::set_tangents(triangles);
  return joined_rows(mesh, faces, triangles);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the tangents of a surface");
}

std::vector<float> tangent_space_normals(const Surface& surface, const MeshAttribute& normals,
                                         const MeshAttribute& tangents, std::span<const float> object_normals,
                                         const Progress& progress) try {
  const map::CornerNormals corners(surface.mesh(), normals, "the surface");
  require_tangents(surface.mesh(), tangents);
  const auto faces = surface.texel_faces();
  if (object_normals.size() != 3 * faces.size())
    throw Error("normals for tangent space must be three numbers for each texel of the surface");
  require_memory(object_normals.size() * sizeof(float), "the tangent-space normals of texels");
  std::vector<float> values(object_normals.size(), baking::kNoValue);
  baking::for_each_texel(
      surface, progress, "tangent space", [&] { return baking::TexelPlaces(internals(surface)); },
      [&](std::uint32_t texel, baking::TexelPlaces& places) {
        const float* const m = object_normals.data() + 3 * std::size_t{texel};
        const Vec3 normal{m[0], m[1], m[2]};
        if (faces[texel] == kNone || !finite(normal)) return;
        const auto place = places.at(texel);
        const Frame frame(tangents, place, corners.at(place.face, place.weights));
        const Vec3 found = frame.coordinates(normal);
        for (int k = 0; k < 3; ++k) values[3 * std::size_t{texel} + k] = static_cast<float>(found[k]);
      });
  return values;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the tangent-space normals of texels");
}

}  // namespace sdm
