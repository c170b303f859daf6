/// Statistics of the parts of a surface: its connected components, or the named groups of its file.
///
/// Threads: the functions may be called concurrently, also with the same map.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/statistics.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sdm {

/// Names that a file gives to faces: those of objects (OBJ o, glTF meshes, solids of STL text, 3DS), of
/// groups (OBJ g; several of one face, as in "g a b", are one name) or of materials (OBJ usemtl, glTF). CAD
/// has objects, the instances of its parts, faces, "face 7" for the seventh if it has no name, and colors,
/// such as "#c0ffee".
struct FaceNames {
  std::string kind;                    ///< "object", "group", "material", "face" or "color"
  std::vector<std::string> names;      ///< each once, in the order of the file
  std::vector<std::uint32_t> of_face;  ///< for each triangle of the mesh, an index into names or kNone
};

/// The faces that have a name.
struct NamedFaces {
  std::string kind;                  ///< as FaceNames::kind
  std::vector<std::uint32_t> faces;  ///< ascending
};

/// Returns the faces with a name: those of the first kind of which a face has it. None if no face has the
/// name, as where all of them were left out. Cost: linear in faces.
[[nodiscard]] SDM_API NamedFaces faces_named(std::span<const FaceNames> names, const std::string& name);

/// Returns the names of the faces of a part of a mesh. `source_face`: of each face of the part, that of the
/// mesh; empty: the part is the mesh. Cost: linear in faces and kinds of names.
[[nodiscard]] SDM_API std::vector<FaceNames> names_of_part(std::span<const FaceNames> names,
                                                           std::span<const std::uint32_t> source_face);

/// Returns the kinds and names of all faces as a clause for messages: "its names are a, b, ..." with the
/// first 20 of them, or "its faces have no names". Cost: linear in names.
[[nodiscard]] SDM_API std::string names_text(std::span<const FaceNames> names);

/// Returns, for each face, the number of its component: the faces that are connected by shared vertices.
/// Components are numbered from 0 in the order of their first faces; removed faces (see MeshEdit) have kNone.
/// Cost: linear.
[[nodiscard]] SDM_API std::vector<std::uint32_t> face_components(const Mesh& mesh);

/// The distances of one part of a surface.
struct PartStatistics {
  std::size_t faces = 0;
  Box box;                                   ///< of the vertices of its faces
  double area_fraction = 0;                  ///< of the area of all texels of the map, in [0, 1]
  DistanceStatistics distance;               ///< of the texels of its faces
  std::optional<ToleranceShares> tolerance;  ///< fractions of the part's own area; if there is one
};

/// Options of part_statistics().
struct PartStatisticsOptions {
  std::optional<Tolerance> tolerance{};
  double accuracy = 0;  ///< of a distance, as for tolerance_shares()
};

/// `part_of_face`: for each face of the surface, the number of its part, below `parts`, or kNone for faces
/// that belong to none. Throws sdm::Error if the map or the parts
/// belong to another surface. Cost: linear in texels and faces, all cores; eight bytes for each texel.
[[nodiscard]] SDM_API std::vector<PartStatistics> part_statistics(const Surface& surface,
                                                                  const DistanceMap& map,
                                                                  std::span<const std::uint32_t> part_of_face,
                                                                  std::size_t parts,
                                                                  const PartStatisticsOptions& options = {});

}  // namespace sdm
