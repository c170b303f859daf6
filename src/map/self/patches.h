// The faces of a mesh grouped into small pieces of its surface.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <vector>

#include "core/arrays/rows.h"

namespace sdm::self {

/// Every face belongs to one patch. Patches are numbered by their first faces.
struct Patches {
  CompressedRows<std::uint32_t> faces;  ///< of each patch, in increasing order
  std::vector<std::uint32_t> of;        ///< the patch of each face

  [[nodiscard]] std::size_t count() const { return faces.size(); }
};

/// The faces of each vertex.
[[nodiscard]] CompressedRows<std::uint32_t> faces_of_vertices(const Mesh& mesh);

/// One patch for each face.
[[nodiscard]] Patches single_faces(std::size_t faces);

/// Groups faces around seeds that are about `radius` apart. A face belongs to the nearest seed, by centroids,
/// among those from which a chain of faces, each sharing a vertex with the next, leads to it without leaving
/// the seed's ball: centroids stay within `radius` of the seed's, corners within 1.5 of it. Faces too large
/// for that are patches of their own. Cost: linear on a surface of bounded valence, as the balls around seeds
/// then overlap a bounded number of times.
[[nodiscard]] Patches group_faces(const Mesh& mesh, const CompressedRows<std::uint32_t>& faces_of_vertex,
                                  double radius);

}  // namespace sdm::self
