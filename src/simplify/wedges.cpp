#include "simplify/wedges.h"

#include <meshoptimizer.h>

#include <utility>

#include "geometry/vec.h"
#include "simplify/uv_faces.h"

namespace sdm::simplify {
namespace {

/// The number of each entry among the different ones, in the order of the first of each; ~0u: unused.
struct Distinct {
  std::vector<std::uint32_t> number;
  std::size_t count = 0;
};

template <class Entry>
Distinct distinct(const std::vector<Entry>& entries, std::span<const std::uint32_t> used) {
  Distinct result{std::vector<std::uint32_t>(entries.size(), kNone)};
  result.count = meshopt_generateVertexRemap(result.number.data(), used.empty() ? nullptr : used.data(),
                                             used.empty() ? entries.size() : used.size(), entries.data(),
                                             entries.size(), sizeof(Entry));
  return result;
}

// Numbers that are equal have the same bits then: −0 becomes 0.
template <std::size_t N>
std::array<double, N> plain(std::array<double, N> numbers) {
  for (double& x : numbers) x += 0.0;
  return numbers;
}

// Numbers the distinct positions of faces in the order of the vertices, and returns that of each vertex.
std::vector<std::uint32_t> weld_positions(const Mesh& mesh, std::vector<Vec3>& positions) {
  std::vector<std::array<double, 3>> entries;
  entries.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) entries.push_back(plain(std::array{p[0], p[1], p[2]}));
  const Distinct welded = distinct(entries, {mesh.triangles.data()->data(), 3 * mesh.triangles.size()});
  std::vector<std::uint32_t> place(welded.count, kNone), vertex(entries.size(), kNone);
  for (std::size_t v = 0; v < entries.size(); ++v) {
    if (welded.number[v] == kNone) continue;
    std::uint32_t& at = place[welded.number[v]];
    if (at == kNone) {
      at = static_cast<std::uint32_t>(positions.size());
      positions.push_back(mesh.positions[v]);
    }
    vertex[v] = at;
  }
  return vertex;
}

// One wedge for each position and texture coordinate.
void divide_by_uvs(const Mesh& mesh, Wedges& wedges, const std::vector<std::size_t>& faces) {
  struct Corner {
    std::uint64_t vertex;  // as large as a double: no bytes are left unset
    std::array<double, 2> uv;
  };
  std::vector<Corner> corners;
  corners.reserve(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Vec2& uv = mesh.corner_uvs[faces[f]][k];
      corners.push_back({wedges.triangles[f][k], plain(std::array{uv[0], uv[1]})});
    }
  const Distinct wedge = distinct(corners, {});
  wedges.vertex.resize(wedge.count);
  wedges.uvs.resize(wedge.count);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    wedges.triangles[i / 3][i % 3] = wedge.number[i];
    wedges.vertex[wedge.number[i]] = static_cast<std::uint32_t>(corners[i].vertex);
    wedges.uvs[wedge.number[i]] = {corners[i].uv[0], corners[i].uv[1]};
  }
}

}  // namespace

Wedges wedges_of(const Mesh& mesh) {
  Wedges wedges;
  const std::vector<std::uint32_t> vertex = weld_positions(mesh, wedges.positions);
  std::vector<std::size_t> faces;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    const Triangle welded{vertex[t[0]], vertex[t[1]], vertex[t[2]]};
    if (welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0]) continue;
    wedges.triangles.push_back(welded);
    faces.push_back(f);
  }
  if (mesh.corner_uvs.empty()) {
    wedges.vertex.resize(wedges.positions.size());
    for (std::uint32_t v = 0; v < wedges.vertex.size(); ++v) wedges.vertex[v] = v;
  } else {
    divide_by_uvs(mesh, wedges, faces);
    wedges.poles = merge_poles(wedges.triangles, wedges.vertex, wedges.uvs);
    find_turns(wedges);
  }
  const Box box = bounds(mesh);
  const Vec3 middle = centre(box);
  wedges.size = diagonal(box);
  wedges.points.reserve(wedges.vertex.size());
  for (const std::uint32_t v : wedges.vertex) {
    const Vec3 p = (1 / wedges.size) * (wedges.positions[v] - middle);
    wedges.points.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  return wedges;
}

std::array<Vec2, 3> uvs_of(const Wedges& wedges, const Triangle& t) {
  std::array<Vec2, 3> uvs{wedges.uvs[t[0]], wedges.uvs[t[1]], wedges.uvs[t[2]]};
  if (wedges.poles.empty()) return uvs;
  for (int k = 0; k < 3; ++k)
    if (const auto pole = wedges.poles.find(t[k]); pole != wedges.poles.end()) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      uvs[k] = uv_at_pole(pole->second, {t[a], t[b]}, {uvs[a], uvs[b]});
    }
  return uvs;
}

Mesh mesh_of(const Wedges& wedges, std::span<const Triangle> triangles, bool single_precision) {
  std::vector<std::uint32_t> place(wedges.positions.size(), kNone);
  for (const Triangle& t : triangles)
    for (const std::uint32_t wedge : t) place[wedges.vertex[wedge]] = 0;
  Mesh mesh;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] == kNone) continue;
    place[v] = static_cast<std::uint32_t>(mesh.positions.size());
    Vec3 p = wedges.positions[v];
    if (single_precision)
      for (double& x : p) x = static_cast<float>(x);
    mesh.positions.push_back(p);
  }
  mesh.triangles.reserve(triangles.size());
  const auto same = [&](std::uint32_t a, std::uint32_t b) { return mesh.positions[a] == mesh.positions[b]; };
  for (const Triangle& t : triangles) {
    Triangle of_mesh;
    for (int k = 0; k < 3; ++k) of_mesh[k] = place[wedges.vertex[t[k]]];
    // Rounding may make corners equal: readers of the file ignore such a face.
    if (single_precision &&
        (same(of_mesh[0], of_mesh[1]) || same(of_mesh[1], of_mesh[2]) || same(of_mesh[2], of_mesh[0])))
      continue;
    mesh.triangles.push_back(of_mesh);
    if (!wedges.uvs.empty()) mesh.corner_uvs.push_back(uvs_of(wedges, t));
  }
  return mesh;
}

}  // namespace sdm::simplify
