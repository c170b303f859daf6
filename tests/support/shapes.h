// Meshes with known properties, built in code.
#pragma once

#include <sdm/mesh.h>
#include <sdm/shape.h>

#include <random>
#include <span>
#include <vector>

namespace sdm::test {

// Closed meshes, oriented outwards.

/// Vertices at the origin and the unit vectors; volume 1/6.
[[nodiscard]] Mesh tetrahedron();
[[nodiscard]] Mesh cube(double half_side = 1);
/// A box between two corners, or of these half sides around the origin; vertices and faces as of cube().
[[nodiscard]] Mesh box(const Vec3& lo, const Vec3& hi);
[[nodiscard]] Mesh box(const Vec3& half_sides);
/// An icosahedron, each face cut into 4^levels, on the unit sphere.
[[nodiscard]] Mesh sphere(int levels);
/// A torus of n × m quads, each two triangles, with radii 2 and 1. Coordinates are exact in single precision;
/// texture coordinates are multiples of 1/n and 1/m, with seams.
[[nodiscard]] Mesh torus(std::uint32_t n, std::uint32_t m);
/// A torus of n × n quads around `origin`, with radii `size` and 0.4·size; without texture coordinates.
[[nodiscard]] Mesh ring(std::uint32_t n, double size = 1, const Vec3& origin = {});
/// A wedge of twice this angle about the plane z = 0. Its sharp edge, along x, has a vertex on one side only,
/// and between them a sliver.
[[nodiscard]] Mesh wedge(double half_angle);

// Open meshes.

[[nodiscard]] Mesh single_triangle();
/// Parallel to the plane z = 0, centred on the z axis at this height.
[[nodiscard]] Mesh square(double side, double height);
/// A band of n quads whose ends are joined, `crossed` (Möbius) or not; 2n triangles.
[[nodiscard]] Mesh band(std::uint32_t n, bool crossed);
/// A flat ring that rises slowly: seen from above it covers itself `turns` times.
[[nodiscard]] Mesh spiral_ramp(int turns, int segments);
/// A closed fan of slivers around one vertex.
[[nodiscard]] Mesh fan(int slivers);
/// 200 needles of length 1 and this width, which share their tip.
[[nodiscard]] Mesh needles(double width);
/// A wavy height field over n² squares, with its ground plane as texture coordinates.
[[nodiscard]] Mesh height_field(int n);

// Triangles that share nothing.

/// Small triangles in and around the unit cube.
[[nodiscard]] Mesh soup(std::size_t triangles, std::mt19937& random);
/// Triangles of any size and place; a tenth of them slivers, a tenth repeated, some without area.
[[nodiscard]] Mesh degenerate_soup(std::size_t triangles, unsigned seed);

// Shapes of meshes, with atlases of this resolution.

[[nodiscard]] std::vector<Shape> with_atlases(std::span<const Mesh> meshes, std::uint32_t resolution);

// Meshes from meshes.

/// The mesh with texture coordinates of its own, laid out as an atlas of charts: the same texels in the same
/// places wherever the mesh is moved to.
[[nodiscard]] Mesh with_own_uvs(Mesh mesh, std::uint32_t resolution = 256);
/// The vertices and faces of both, without texture coordinates.
[[nodiscard]] Mesh joined(const Mesh& a, const Mesh& b);
[[nodiscard]] Mesh moved(Mesh mesh, const Vec3& by);
/// Every face with vertices of its own, each moved by up to `error` along each axis.
[[nodiscard]] Mesh taken_apart(const Mesh& mesh, double error, unsigned seed = 1);
/// Every face flipped, or every n-th only; without texture coordinates.
[[nodiscard]] Mesh flipped(Mesh mesh, std::size_t every = 1);
/// A third of the faces flipped, and added to it: edges of three faces, duplicates, faces without area.
[[nodiscard]] Mesh with_defects(const Mesh& mesh);

}  // namespace sdm::test
