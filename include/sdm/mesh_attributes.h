/// What a mesh has at the corners of its faces, besides positions and texture coordinates: normals, colours,
/// and numbers of any name.
///
/// Threads: plain values; the function may be called concurrently, also with the same mesh.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>
#include <sdm/types.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace sdm {

/// An array of a file, as rows of numbers that corners of faces refer to. Values may jump between the faces
/// around a vertex, where the file has several rows for it.
struct MeshAttribute {
  /// `normal`, three components, as the file has them, moved as the faces are; `color`, three or four
  /// components from 0 to 1, in linear light; `uv1`, `uv2`, ...: further sets of texture coordinates; `uv0`:
  /// those of Mesh::corner_uvs, which is empty then, where only some corners have them; others as in the
  /// file. `face_color`, `face_...`: of faces, where vertices have an array of that name.
  std::string name;
  std::size_t components = 1;
  std::vector<float> values;  ///< row after row
  /// The rows of the corners of each triangle of the mesh; kNone: the file has none. Arrays that the file
  /// has for its vertices share them.
  std::shared_ptr<const std::vector<Triangle>> rows;
};

/// Returns the attribute `normal` of a mesh whose file has none: at each vertex, the mean of the normals of
/// its faces, weighted by their angles there, of length 1. Faces that differ by more than `crease` degrees
/// from the first one of a vertex do not share its normal; from 180 on, all do. Normals point to the side
/// from which the corners of faces are counter-clockwise; faces without area take those of others, or (0, 0,
/// 1). Throws sdm::Error for a negative angle, or if there is not enough memory. Cost: linear.
[[nodiscard]] SDM_API MeshAttribute smooth_normals(const Mesh& mesh, double crease = 180);

/// The crease of the normals that models are drawn with.
inline constexpr double kDrawnCrease = 40;

}  // namespace sdm
