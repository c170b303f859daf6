/// What a mesh has at the corners of its faces, besides positions and texture coordinates: normals, colours,
/// and numbers of any name.
///
/// Threads: plain values.
#pragma once

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
  /// components from 0 to 1, in linear light; `uv1`, `uv2`, ...: further sets of texture coordinates; others
  /// as in the file. `face_color`, `face_...`: of faces, where vertices have an array of that name.
  std::string name;
  std::size_t components = 1;
  std::vector<float> values;  ///< row after row
  /// For each triangle of the mesh, the rows of its corners; kNone: the file has none. Arrays that the file
  /// has for its vertices share them.
  std::shared_ptr<const std::vector<Triangle>> rows;
};

}  // namespace sdm
