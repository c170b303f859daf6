// Normals at points of a mesh, interpolated between the corners of its faces.
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_attributes.h>

#include <cstdint>

namespace sdm::map {

class CornerNormals {
 public:
  /// Both must outlive this and not change. Throws sdm::Error, naming the normals as `whose`, unless they are
  /// three finite components, or none, for each corner.
  CornerNormals(const Mesh& mesh, const MeshAttribute& normals, const char* whose);

  /// The normal at a corner; that of the face where the attribute has none or 0.
  [[nodiscard]] Vec3 of_corner(std::uint32_t face, int corner) const;
  /// The interpolated normal, not of length 1; the face's where it is 0.
  [[nodiscard]] Vec3 at(std::uint32_t face, const Vec3& weights) const;

 private:
  [[nodiscard]] Vec3 of_face(std::uint32_t face) const;

  const Mesh& mesh_;
  const MeshAttribute& normals_;
};

}  // namespace sdm::map
