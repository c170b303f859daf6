#include "map/transfer/corner_normals.h"

#include <sdm/error.h>
#include <sdm/mesh_edit.h>

#include <cmath>
#include <string>

#include "geometry/triangle.h"

namespace sdm::map {

CornerNormals::CornerNormals(const Mesh& mesh, const MeshAttribute& normals, const char* whose)
    : mesh_(mesh), normals_(normals) {
  const std::string name = std::string("the normals of ") + whose;
  if (normals.components != 3 || normals.values.size() % 3 != 0)
    throw Error(name + " must have three components");
  if (!normals.rows || normals.rows->size() != mesh.triangles.size())
    throw Error(name + " must have a row for each corner of its faces");
  const std::size_t count = normals.values.size() / 3;
  for (const Triangle& of_face : *normals.rows)
    for (const std::uint32_t row : of_face)
      if (row != kNone && row >= count)
        throw Error(name + ": there are " + std::to_string(count) + " rows, but a corner refers to row " +
                    std::to_string(row));
}

Vec3 CornerNormals::of_face(std::uint32_t face) const {
  if (is_removed(mesh_.triangles[face])) return {};
  const auto [a, b, c] = corners_of(mesh_, face);
  return normalized(cross(b - a, c - a));
}

Vec3 CornerNormals::of_corner(std::uint32_t face, int corner) const {
  const std::uint32_t row = (*normals_.rows)[face][corner];
  if (row == kNone) return of_face(face);
  const float* const n = normals_.values.data() + 3 * std::size_t{row};
  const Vec3 normal{n[0], n[1], n[2]};
  const bool known = std::isfinite(n[0]) && std::isfinite(n[1]) && std::isfinite(n[2]) && normal != Vec3{};
  return known ? normal : of_face(face);
}

Vec3 CornerNormals::at(std::uint32_t face, const Vec3& weights) const {
  Vec3 sum{};
  for (int k = 0; k < 3; ++k) sum += weights[k] * of_corner(face, k);
  return sum == Vec3{} ? of_face(face) : sum;
}

}  // namespace sdm::map
