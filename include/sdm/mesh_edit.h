/// Meshes made from a mesh: transformed, edited, its convex hull; welded along boundary edges that coincide
/// but for rounding, as of CAD models whose faces were written one by one; without islands, which are small
/// connected components, such as the floating specks of a scan.
///
/// Threads: plain values; the functions may be called concurrently, also with the same mesh; apply()
/// and transform() with different ones.
#pragma once

#include <sdm/execution.h>
#include <sdm/mesh.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// An affine map as a 4×4 matrix M in row-major order, for column vectors: p ↦ M (p, 1). The last row is
/// (0, 0, 0, 1). The identity by default.
struct SDM_API Transform {
  std::array<std::array<double, 4>, 4> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

  /// Adds an offset.
  [[nodiscard]] static Transform translation(const Vec3& offset);
  /// Multiplies by a factor, about the origin.
  [[nodiscard]] static Transform scaling(double factor);
  /// Rotates about the X, then the Y, then the Z axis, right-handed. Multiples of 90° are exact.
  [[nodiscard]] static Transform rotation(const Vec3& degrees);
  /// The rotation of a quaternion w + x i + y j + z k, which need not have length 1. Throws sdm::Error if it
  /// is zero or not finite.
  [[nodiscard]] static Transform quaternion(const std::array<double, 4>& wxyz);

  /// Maps a point.
  [[nodiscard]] Vec3 operator()(const Vec3& p) const;
  /// Maps a normal of a surface to that of the mapped surface, of unit length: by the inverse transpose of
  /// the linear part, so that it stays perpendicular to the surface, and on its outside under a reflection
  /// too. 0 if the map is singular, or `n` is 0 or not finite.
  [[nodiscard]] Vec3 normal(const Vec3& n) const;
  /// The map that takes M p back to p: by the cofactors, so that the rotations and translations of poses are
  /// inverted to rounding. Throws sdm::Error if the map is singular or an entry of the inverse is not finite.
  [[nodiscard]] Transform inverse() const;
  /// The determinant of the linear part; negative for a reflection.
  [[nodiscard]] double determinant() const;
  /// The sign of the determinant, without rounding: −1 for a reflection, 0 for a singular map.
  [[nodiscard]] int orientation() const;
  /// (a * b)(p) = a(b(p)) up to rounding.
  friend SDM_API Transform operator*(const Transform& a, const Transform& b);
};

/// Returns the uniform scaling and translation that make the longest side of the bounds 1 and centre them at
/// the origin. Throws sdm::Error unless the bounds have a positive extent. Cost: linear.
[[nodiscard]] SDM_API Transform fit_to_unit(const Mesh& mesh);

/// Maps all positions; a reflection also reverses the faces, so that they keep facing outwards. Throws
/// sdm::Error, and changes nothing, if a coordinate becomes infinite or NaN. Cost: linear.
SDM_API void transform(Mesh& mesh, const Transform& map);
/// The same for points alone.
SDM_API void transform(std::span<Vec3> points, const Transform& map);

/// Vertices moved and added; faces removed, reconnected and added.
///
/// Numbers are stable. Vertices and faces keep theirs for good, and no number is used twice: added vertices
/// follow the present ones, added faces the present faces, both in the order of their lists. Vertices are
/// never removed; those of no face are ignored everywhere. A removed face keeps its place in Mesh::triangles
/// as (v, v, v), v its former first corner. Such a face has no sites, no texels and no area, and does not
/// count for bounds().
struct MeshEdit {
  /// A vertex and its new position.
  struct MovedVertex {
    std::uint32_t vertex;
    Vec3 position;
  };
  /// A face and its new vertices.
  struct ReconnectedFace {
    std::uint32_t face;
    Triangle triangle;  ///< its new corners; may refer to added vertices
  };

  std::vector<std::uint32_t> removed_faces{};
  /// Faces that stay but get other corners: to tear a mesh, faces on one side of the tear get copies of the
  /// vertices. A Surface keeps the triangle of the face in the atlas.
  std::vector<ReconnectedFace> reconnected_faces{};
  std::vector<MovedVertex> moved_vertices{};
  std::vector<Vec3> added_vertices{};
  std::vector<Triangle> added_faces{};  ///< may refer to added vertices
  /// Texture coordinates at the corners of the added faces, for meshes that have them; empty: zeros.
  std::vector<std::array<Vec2, 3>> added_corner_uvs{};
};

/// Whether a triangle is the place of a removed face: its three corners are one vertex.
[[nodiscard]] constexpr bool is_removed(const Triangle& triangle) {
  return triangle[0] == triangle[1] && triangle[1] == triangle[2];
}

/// Changes the mesh, which must be valid in the sense of validate(). Throws sdm::Error, and changes nothing,
/// if an index is out of range, if a face is removed or reconnected twice, or has been removed before, if a
/// new triangle has three equal corners, if there are texture coordinates for some added faces only or for a
/// mesh without any, if the result is not valid, or if there is not enough memory. Cost: by the size of the
/// edit, plus the bounds of the result, which take a pass over its faces.
SDM_API void apply(Mesh& mesh, const MeshEdit& edit);

/// Options of weld().
struct WeldOptions {
  /// Greater than 0, in units of the mesh: edges are joined if their ends are at most this far apart. Without
  /// a value, edges up to 1e-3 of the diagonal of the mesh's box are.
  std::optional<double> tolerance{};
  Progress progress{};
};

template <>
inline constexpr auto kOptions<WeldOptions> = std::tuple{
    Option{.name = "tolerance",
           .member = &WeldOptions::tolerance,
           .text = "Edges are joined whose ends are at most this far apart; by default up to 0.001 of the "
                   "diagonal of the mesh. No gap wider than a quarter of its edges is closed.",
           .range = kPositive,
           .unit = "length",
           .value = "T"}};

/// What weld() did.
struct WeldReport {
  /// The largest distance between the ends of two edges that were joined; 0 if none were.
  double tolerance = 0;
  double largest_move = 0;  ///< of a vertex; several edges that meet may add up to more than tolerance
  std::size_t joined_vertices = 0;  ///< that have no face any more
  std::size_t boundary_edges = 0;   ///< that are left
  /// Vertices of boundary edges that are left, which lie on another one within the tolerance: one edge there
  /// meets several, and joining vertices closes no such gap.
  std::size_t t_junctions = 0;
};

template <>
inline constexpr std::tuple kFields<WeldReport>{
    Field{"tolerance", &WeldReport::tolerance,
          "The largest distance between the ends of two edges that were joined."},
    Field{"largest_move", &WeldReport::largest_move,
          "The largest move of a vertex: distances to the welded mesh differ from those to the mesh by at "
          "most this."},
    Field{"joined_vertices", &WeldReport::joined_vertices, "The vertices that have no face any more."},
    Field{"boundary_edges", &WeldReport::boundary_edges, "The boundary edges that are left."},
    Field{"t_junctions", &WeldReport::t_junctions,
          "Their vertices that lie in the middle of another one, within the tolerance."}};

/// A mesh whose boundary edges were joined, and how.
struct Welded : WeldReport {
  /// All vertices keep their number; those that were joined to another one have its position and no face.
  Mesh mesh{};
  std::vector<std::uint32_t> vertex{};  ///< of each vertex, the one that its faces have now
};

/// Joins each boundary edge with the one whose ends are closest to its own, within the tolerance and a
/// quarter of the shorter edge's length. Edges that run in opposite directions, as neighbours do that are
/// oriented alike, come first. No two vertices of one face are joined, so no face collapses; nor edges of two
/// faces that turn their backs on each other less than twice the tolerance apart: they are the sides of a
/// thin wall. Distances to the welded mesh differ from those to the mesh by at most largest_move.
///
/// Throws sdm::Error if the mesh is unusable (see validate), for a tolerance that is not positive, or if
/// there is not enough memory; Cancelled. The result does not depend on the number of threads. Cost: that of
/// the topology, and sorting the boundary edges in space.
[[nodiscard]] SDM_API Welded weld(const Mesh& mesh, const WeldOptions& options = {});

/// The convex hull of the corners of all faces: a closed mesh of triangles, counter-clockwise from outside.
/// Its vertices are corners at their positions, to the bit, in their order; no corner is outside, and no edge
/// reflex, which is decided exactly. Shape::convex() of it is true, unless it has more vertices than that
/// looks at, or is as thin as rounding. Faces in one plane are divided into
/// triangles; corners inside of faces and edges of the hull are left out, as a rule.
///
/// Throws sdm::Error for a mesh that is not valid, for one whose corners are in one plane, and if there is
/// not enough memory. Cost: O(n log n) as a rule, single-threaded.
[[nodiscard]] SDM_API Mesh convex_hull(const Mesh& mesh);

/// Which components are islands: those below one of these limits. A limit of 0 has no effect.
struct IslandLimits {
  std::size_t faces = 0;
  double area = 0;           ///< in squared units of the mesh; ≥ 0
  double area_fraction = 0;  ///< of the area of the mesh; in [0, 1]
};

/// What was removed.
struct IslandReport {
  std::size_t islands = 0, faces = 0;
  double area = 0;
  double area_fraction = 0;  ///< of the area of the mesh, in [0, 1]
};

template <>
inline constexpr std::tuple kFields<IslandReport>{
    Field{"islands", &IslandReport::islands, "The number of components."},
    Field{"faces", &IslandReport::faces, "The number of their faces."},
    Field{"area", &IslandReport::area, "Their area."},
    Field{"area_fraction", &IslandReport::area_fraction, "That as a fraction of the area of the mesh."}};

/// A mesh without its islands. Its vertices have the numbers that they had; some may have no face.
struct WithoutIslands : IslandReport {
  Mesh mesh;
  std::vector<std::uint32_t> face;  ///< the number that each of its faces had; removed faces are not left
};

/// Returns the mesh without the components (see face_components()) that are below a limit. Throws sdm::Error
/// for a mesh that is unusable (see validate) or without islands would be, and for limits out of range. Cost:
/// linear.
[[nodiscard]] SDM_API WithoutIslands remove_islands(const Mesh& mesh, const IslandLimits& limits);

}  // namespace sdm
