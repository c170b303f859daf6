#include "edit/random_edits.h"

#include <algorithm>

namespace sdm::test {
namespace {

bool repeats_a_corner(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

std::vector<std::uint32_t> faces_at(const Mesh& mesh, std::uint32_t vertex) {
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
    if (!repeats_a_corner(mesh.triangles[f]) && std::ranges::count(mesh.triangles[f], vertex) > 0)
      faces.push_back(f);
  return faces;
}

double edge_length(const Mesh& mesh, std::uint32_t face) {
  const auto& [a, b, c] = mesh.triangles[face];
  return norm(mesh.positions[b] - mesh.positions[a]) + norm(mesh.positions[c] - mesh.positions[a]);
}

}  // namespace

std::uint32_t RandomEdits::present_face(const Mesh& mesh) {
  for (;;)
    if (const std::size_t face = below(mesh.triangles.size()); !repeats_a_corner(mesh.triangles[face]))
      return static_cast<std::uint32_t>(face);
}

Vec3 RandomEdits::offset(double length) {
  std::uniform_real_distribution<double> u(-length, length);
  return {u(random_), u(random_), u(random_)};
}

void RandomEdits::remove(const Mesh& mesh, MeshEdit& edit) {
  const std::uint32_t face = present_face(mesh);
  edit.removed_faces = faces_at(mesh, mesh.triangles[face][0]);
  if (below(2) == 0) edit.removed_faces.resize(1);
  for (const std::uint32_t f : edit.removed_faces) removed_.push_back(mesh.triangles[f]);
}

void RandomEdits::put_back(MeshEdit& edit) {
  std::ranges::shuffle(removed_, random_);
  const std::size_t count = std::min<std::size_t>(removed_.size(), 1 + below(8));
  edit.added_faces.insert(edit.added_faces.end(), removed_.end() - static_cast<std::ptrdiff_t>(count),
                          removed_.end());
  removed_.resize(removed_.size() - count);
}

// A strip of new vertices that begins at the edge of a face.
void RandomEdits::add(const Mesh& mesh, MeshEdit& edit) {
  const std::uint32_t face = present_face(mesh);
  const double length = edge_length(mesh, face);
  std::uint32_t a = mesh.triangles[face][0], b = mesh.triangles[face][1];
  Vec3 p = mesh.positions[b];
  for (std::size_t i = 0, n = 1 + below(9); i < n; ++i) {
    p += offset(0.5 * length);
    const auto c = static_cast<std::uint32_t>(mesh.positions.size() + edit.added_vertices.size());
    edit.added_vertices.push_back(p);
    edit.added_faces.push_back({b, a, c});
    a = b;
    b = c;
  }
}

// Faces on one side of a vertex get a copy of it.
void RandomEdits::tear(const Mesh& mesh, MeshEdit& edit) {
  const std::uint32_t vertex = mesh.triangles[present_face(mesh)][0];
  const Vec3 normal = offset(1);
  const auto copy = static_cast<std::uint32_t>(mesh.positions.size() + edit.added_vertices.size());
  for (const std::uint32_t f : faces_at(mesh, vertex)) {
    if (std::ranges::count(edit.removed_faces, f) > 0) continue;
    Triangle t = mesh.triangles[f];
    Vec3 middle{};
    for (const std::uint32_t v : t) middle += (1.0 / 3) * mesh.positions[v];
    if (dot(middle - mesh.positions[vertex], normal) > 0) continue;
    std::ranges::replace(t, vertex, copy);
    edit.reconnected_faces.push_back({f, t});
  }
  edit.added_vertices.push_back(mesh.positions[vertex] + (below(2) == 0 ? Vec3{} : offset(1e-3)));
}

void RandomEdits::move(const Mesh& mesh, MeshEdit& edit) {
  for (std::size_t i = 0, n = 1 + below(5); i < n; ++i) {
    const std::uint32_t face = present_face(mesh), v = mesh.triangles[face][0];
    edit.moved_vertices.push_back({v, mesh.positions[v] + offset(0.05 * edge_length(mesh, face))});
  }
}

void RandomEdits::add_defects(const Mesh& mesh, MeshEdit& edit) {
  const Triangle t = mesh.triangles[present_face(mesh)];
  edit.added_faces.push_back(below(2) == 0 ? Triangle{t[1], t[0], t[2]} : Triangle{t[0], t[0], t[1]});
}

MeshEdit RandomEdits::next(const Mesh& mesh) {
  MeshEdit edit;
  for (std::size_t i = 0, n = 1 + below(2); i < n; ++i) {
    switch (below(5)) {
      case 0:
        if (edit.removed_faces.empty() && edit.reconnected_faces.empty()) remove(mesh, edit);
        break;
      case 1:
        put_back(edit);
        break;
      case 2:
        add(mesh, edit);
        break;
      case 3:
        if (edit.reconnected_faces.empty()) tear(mesh, edit);
        break;
      default:
        if (kinds_.moves) move(mesh, edit);
    }
  }
  if (kinds_.defects && below(40) == 0) add_defects(mesh, edit);
  return edit;
}

}  // namespace sdm::test
