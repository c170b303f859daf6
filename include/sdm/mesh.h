/// Triangle meshes: any triangle soup, open or closed, manifold or not; how those of CAD files were made, and
/// units of length.
///
/// Threads: plain values; the functions may be called concurrently, also with the same mesh.
#pragma once

#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace sdm {

/// A triangle soup with shared vertices.
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  /// Texture coordinates of each triangle's three corners, (0, 0) at the lower left of the image; empty, or
  /// one entry per triangle.
  std::vector<std::array<Vec2, 3>> corner_uvs;
};

/// Throws sdm::Error unless the mesh can be used: every index in range, every coordinate finite and at most
/// 1e37 in magnitude, the extent of the mesh above 1e-30, at most 2^30 triangles, at least one of them with
/// an area, and texture coordinates finite and present for all triangles or none. Cost: linear.
SDM_API void validate(const Mesh& mesh);

/// Returns the bounding box of all vertices that triangles use; removed faces (see MeshEdit) use none. Cost:
/// linear.
[[nodiscard]] SDM_API Box bounds(const Mesh& mesh);

/// Counts and topology of a mesh, as printed by `sdm info`.
struct MeshInfo {
  std::size_t vertices = 0, triangles = 0, edges = 0;
  Box bounds;
  std::size_t components = 0;            ///< sets of faces connected by shared vertices
  std::size_t boundary_edges = 0;        ///< edges of exactly one face
  std::size_t nonmanifold_edges = 0;     ///< edges of three faces or more
  std::size_t nonmanifold_vertices = 0;  ///< vertices whose faces do not form one fan
  std::size_t degenerate_faces = 0;      ///< faces of zero area, repeated corners included
  std::size_t duplicate_faces = 0;       ///< faces with the same three vertices as an earlier face
  std::size_t unused_vertices = 0;       ///< vertices of no face
  bool closed = false;                   ///< no boundary edge and no non-manifold edge
  bool orientable = false;               ///< the faces can be oriented consistently
  bool oriented = false;                 ///< the faces are oriented consistently
  bool manifold = false;                 ///< no non-manifold edge or vertex
  bool has_uvs = false;
  double area = 0;
};

template <>
inline constexpr std::tuple kFields<MeshInfo>{
    Field{"vertices", &MeshInfo::vertices, "The number of vertices."},
    Field{"edges", &MeshInfo::edges, "The number of edges."},
    Field{"triangles", &MeshInfo::triangles, "The number of triangles."},
    Field{"bounds", &MeshInfo::bounds, "The box of the vertices."},
    Field{"components", &MeshInfo::components, "Sets of faces that are connected by shared vertices."},
    Field{"closed", &MeshInfo::closed, "There is no boundary edge and no non-manifold edge."},
    Field{"orientable", &MeshInfo::orientable, "The faces can be oriented consistently."},
    Field{"oriented", &MeshInfo::oriented, "The faces are oriented consistently."},
    Field{"manifold", &MeshInfo::manifold, "There is no non-manifold edge or vertex."},
    Field{"boundary_edges", &MeshInfo::boundary_edges, "Edges of exactly one face."},
    Field{"nonmanifold_edges", &MeshInfo::nonmanifold_edges, "Edges of three faces or more."},
    Field{"nonmanifold_vertices", &MeshInfo::nonmanifold_vertices,
          "Vertices whose faces do not form one fan."},
    Field{"degenerate_faces", &MeshInfo::degenerate_faces, "Faces without area, repeated corners included."},
    Field{"duplicate_faces", &MeshInfo::duplicate_faces,
          "Faces with the same three vertices as an earlier face."},
    Field{"unused_vertices", &MeshInfo::unused_vertices, "Vertices of no face."},
    Field{"uvs", &MeshInfo::has_uvs, "There are texture coordinates."},
    Field{"area", &MeshInfo::area, "The area of the surface."}};

/// Computes the counts and the topology of a mesh. Duplicate faces, and degenerate faces with repeated
/// corners, do not count as incident to edges. Cost: O(n log n).
[[nodiscard]] SDM_API MeshInfo inspect(const Mesh& mesh);

/// What is asked of the triangles of a CAD file.
struct TessellationOptions {
  /// The distance from the triangles to the exact surface that is aimed at, in millimetres. Nothing: 1/2000
  /// of the diagonal of the part's box.
  std::optional<double> deflection{};
  /// The largest deflection, in millimetres, where none is given; a part that would have more than
  /// `most_triangles` has a larger one.
  std::optional<double> at_most{};
  std::size_t most_triangles = 2'000'000;
  double angle =
      0.2;  ///< the angle in radians between the normals of neighbouring triangles that is aimed at
};

template <>
inline constexpr auto kOptions<TessellationOptions> = std::tuple{
    Option{.name = "deflection",
           .member = &TessellationOptions::deflection,
           .text = "The distance in mm that triangles of STEP and IGES may have from the surface, as "
                   "OpenCASCADE keeps it; by default 1/2000 of the diagonal, or a tenth of the tolerance if "
                   "that is less, with up to 2 million triangles. What was measured is reported, as an "
                   "estimate, and verdicts keep so far from the limits.",
           .range = kPositive,
           .value = "D"},
    Option{.name = "angle",
           .member = &TessellationOptions::angle,
           .text = "The angle in radians between the normals of neighbouring triangles of STEP and IGES that "
                   "is aimed at.",
           .range = {.least = 0, .most = 1.5707963267948966, .above = true, .below = true},
           .value = "A"}};

/// The tessellation of a CAD file. Coordinates are in millimetres, whatever the unit of the file.
struct Tessellation {
  std::string format;                ///< "STEP" or "IGES"
  std::string file_unit;             ///< as the file has it, such as "INCH"; empty if it has none
  std::size_t faces = 0;             ///< of all instances of all parts
  std::size_t omitted_faces = 0;     ///< of them, without a triangle, since they could not be tessellated
  double deflection = 0, angle = 0;  ///< that were aimed at
  bool limited = false;              ///< the deflection is above TessellationOptions::at_most
  /// An estimate: the largest distance from a point of the exact surfaces and edges to the triangles, over
  /// points inside of each triangle and of each side on an edge. Other points may be farther.
  double largest_deviation = 0;
  std::size_t measured_points = 0;
};

template <>
inline constexpr std::tuple kFields<Tessellation>{
    Field{"format", &Tessellation::format, "'STEP' or 'IGES'."},
    Field{"file_unit", &Tessellation::file_unit, "The unit of the file; empty if it has none."},
    Field{"faces", &Tessellation::faces, "The faces of all instances of all parts."},
    Field{"omitted_faces", &Tessellation::omitted_faces, "Those that could not be tessellated."},
    Field{"deflection", &Tessellation::deflection, "The deflection that was aimed at."},
    Field{"angle", &Tessellation::angle, "The angle that was aimed at."},
    Field{"largest_deviation", &Tessellation::largest_deviation,
          "An estimate: how far the triangles were found to be from the exact surfaces."},
    Field{"measured_points", &Tessellation::measured_points, "The points that this is from."}};

/// Returns a sentence that distances are to the triangles, by how much these were found to deviate from the
/// surface of `file`, and that verdicts keep so far from the limits.
[[nodiscard]] SDM_API std::string note_on(const Tessellation& tessellation, const std::string& file);

/// The length in metres of "m", "cm", "mm", "um" or "µm", "in" or "ft"; nothing for any other name.
[[nodiscard]] SDM_API std::optional<double> metres_per(std::string_view unit);

}  // namespace sdm
