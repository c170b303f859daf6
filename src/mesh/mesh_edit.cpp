#include <sdm/error.h>
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <new>
#include <string>
#include <utility>

#include "core/cancellation.h"
#include "core/memory.h"
#include "mesh/validate.h"

namespace sdm {
namespace {

[[noreturn]] void fail(const std::string& what, std::size_t index, const std::string& fault) {
  throw Error("the edit of the mesh " + what + ' ' + std::to_string(index) + ", " + fault);
}

void check_triangle(const Triangle& triangle, std::size_t vertices, const char* what, std::size_t face) {
  for (const std::uint32_t v : triangle)
    if (v >= vertices)
      fail(what, face,
           "whose corner " + std::to_string(v) + " is none of the " + std::to_string(vertices) + " vertices");
  if (is_removed(triangle)) fail(what, face, "whose corners are all the same vertex");
}

void check(const Mesh& mesh, const MeshEdit& edit) {
  const std::size_t faces = mesh.triangles.size(),
                    vertices = mesh.positions.size() + edit.added_vertices.size();
  std::vector<std::uint32_t> changed;
  const auto check_face = [&](std::uint32_t face, const char* what) {
    if (face >= faces) fail(what, face, "but there are " + std::to_string(faces) + " faces");
    if (is_removed(mesh.triangles[face])) fail(what, face, "which has been removed before");
    changed.push_back(face);
  };
  for (const std::uint32_t face : edit.removed_faces) check_face(face, "removes face");
  for (const auto& [face, triangle] : edit.reconnected_faces) {
    check_face(face, "reconnects face");
    check_triangle(triangle, vertices, "reconnects face", face);
  }
  std::ranges::sort(changed);
  if (const auto twice = std::ranges::adjacent_find(changed); twice != changed.end())
    fail("changes face", *twice, "which it changes twice");
  std::vector<Vec3> positions;
  for (const auto& [vertex, position] : edit.moved_vertices) {
    if (vertex >= mesh.positions.size())
      fail("moves vertex", vertex, "but there are " + std::to_string(mesh.positions.size()) + " vertices");
    positions.push_back(position);
  }
  mesh::validate_positions(positions);
  mesh::validate_positions(edit.added_vertices);
  for (std::size_t i = 0; i < edit.added_faces.size(); ++i)
    check_triangle(edit.added_faces[i], vertices, "adds face", faces + i);
  if (!edit.added_corner_uvs.empty() &&
      (mesh.corner_uvs.empty() || edit.added_corner_uvs.size() != edit.added_faces.size()))
    throw Error("the edit of the mesh has texture coordinates for " +
                std::to_string(edit.added_corner_uvs.size()) + " of " +
                std::to_string(edit.added_faces.size()) +
                " added faces; give them for all or for none, and for none if the mesh has none");
}

// What an edit overwrites.
struct Before {
  std::size_t vertices, faces;
  std::vector<std::pair<std::uint32_t, Vec3>> positions;
  std::vector<std::pair<std::uint32_t, Triangle>> triangles;

  Before(const Mesh& mesh, const MeshEdit& edit)
      : vertices(mesh.positions.size()), faces(mesh.triangles.size()) {
    for (const auto& moved : edit.moved_vertices)
      positions.emplace_back(moved.vertex, mesh.positions[moved.vertex]);
    for (const std::uint32_t face : edit.removed_faces) triangles.emplace_back(face, mesh.triangles[face]);
    for (const auto& reconnected : edit.reconnected_faces)
      triangles.emplace_back(reconnected.face, mesh.triangles[reconnected.face]);
  }
  // Allocates nothing.
  void restore(Mesh& mesh) const {
    mesh.positions.resize(vertices);
    mesh.triangles.resize(faces);
    if (!mesh.corner_uvs.empty()) mesh.corner_uvs.resize(faces);
    for (const auto& [vertex, position] : positions) mesh.positions[vertex] = position;
    for (const auto& [face, triangle] : triangles) mesh.triangles[face] = triangle;
  }
};

}  // namespace

void apply(Mesh& mesh, const MeshEdit& edit) try {
  const Uncancellable whole;
  check(mesh, edit);
  const Before before(mesh, edit);
  try {
    mesh.positions.insert(mesh.positions.end(), edit.added_vertices.begin(), edit.added_vertices.end());
    for (const auto& [vertex, position] : edit.moved_vertices) mesh.positions[vertex] = position;
    for (const std::uint32_t face : edit.removed_faces) mesh.triangles[face].fill(mesh.triangles[face][0]);
    for (const auto& [face, triangle] : edit.reconnected_faces) mesh.triangles[face] = triangle;
    mesh.triangles.insert(mesh.triangles.end(), edit.added_faces.begin(), edit.added_faces.end());
    if (!mesh.corner_uvs.empty()) {
      mesh.corner_uvs.insert(mesh.corner_uvs.end(), edit.added_corner_uvs.begin(),
                             edit.added_corner_uvs.end());
      mesh.corner_uvs.resize(mesh.triangles.size());
    }
    mesh::validate_edited(mesh);
  } catch (...) {
    before.restore(mesh);
    throw;
  }
} catch (const std::bad_alloc&) {
  throw out_of_memory("the edit of a mesh");
}

}  // namespace sdm
