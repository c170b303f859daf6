#include "simplify/wedges.h"

#include <meshoptimizer.h>

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

// Whether a vertex has faces of several regions.
bool meet(const Wedges& wedges, const std::vector<std::uint32_t>& region_of_face) {
  std::vector<std::uint32_t> region(wedges.positions.size(), kNone);
  for (std::size_t f = 0; f < region_of_face.size(); ++f)
    for (const std::uint32_t v : wedges.triangles[f]) {
      if (region[v] != kNone && region[v] != region_of_face[f]) return true;
      region[v] = region_of_face[f];
    }
  return false;
}

// One wedge for each position, texture coordinate and region.
void divide(const Mesh& mesh, Wedges& wedges, const std::vector<std::size_t>& faces,
            const std::vector<std::uint32_t>& region_of_face) {
  struct Corner {
    std::uint64_t vertex, region;  // as large as a double: no bytes are left unset
    std::array<double, 2> uv;
  };
  std::vector<Corner> corners;
  corners.reserve(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Vec2 uv = mesh.corner_uvs.empty() ? Vec2{} : mesh.corner_uvs[faces[f]][k];
      corners.push_back({wedges.triangles[f][k], region_of_face.empty() ? 0 : region_of_face[f],
                         plain(std::array{uv[0], uv[1]})});
    }
  const Distinct wedge = distinct(corners, {});
  wedges.vertex.resize(wedge.count);
  if (!mesh.corner_uvs.empty()) wedges.uvs.resize(wedge.count);
  if (!region_of_face.empty()) wedges.regions.resize(wedge.count);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::uint32_t number = wedge.number[i];
    wedges.triangles[i / 3][i % 3] = number;
    wedges.vertex[number] = static_cast<std::uint32_t>(corners[i].vertex);
    if (!wedges.uvs.empty()) wedges.uvs[number] = {corners[i].uv[0], corners[i].uv[1]};
    if (!wedges.regions.empty()) wedges.regions[number] = static_cast<std::uint32_t>(corners[i].region);
  }
}

}  // namespace

Wedges wedges_of(const Mesh& mesh, std::span<const std::uint32_t> regions) {
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
  std::vector<std::uint32_t> region_of_face;
  for (std::size_t i = 0; i < faces.size() && !regions.empty(); ++i)
    region_of_face.push_back(regions[faces[i]]);
  if (mesh.corner_uvs.empty() && !meet(wedges, region_of_face)) {
    wedges.vertex.resize(wedges.positions.size());
    for (std::uint32_t v = 0; v < wedges.vertex.size(); ++v) wedges.vertex[v] = v;
    if (!regions.empty()) wedges.regions.resize(wedges.vertex.size());
    for (std::size_t f = 0; f < region_of_face.size(); ++f)
      for (const std::uint32_t v : wedges.triangles[f]) wedges.regions[v] = region_of_face[f];
  } else {
    divide(mesh, wedges, faces, region_of_face);
  }
  if (!mesh.corner_uvs.empty()) {
    merge_poles(wedges);
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

MeshOfWedges mesh_of(const Wedges& wedges, std::span<const Triangle> triangles, bool single_precision) {
  std::vector<std::uint32_t> place(wedges.positions.size(), kNone);
  for (const Triangle& t : triangles)
    for (const std::uint32_t wedge : t) place[wedges.vertex[wedge]] = 0;
  MeshOfWedges result;
  Mesh& mesh = result.mesh;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] == kNone) continue;
    place[v] = static_cast<std::uint32_t>(mesh.positions.size());
    const Vec3& p = wedges.positions[v];
    mesh.positions.push_back(single_precision ? rounded_to_float(p) : p);
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
    if (!wedges.regions.empty()) result.source_faces.push_back(wedges.regions[t[0]]);
    if (!wedges.uvs.empty()) mesh.corner_uvs.push_back(uvs_of(wedges, t));
  }
  return result;
}

Vec3 rounded_to_float(const Vec3& p) {
  // GCC 12 with -O3 drops the conversions of two neighbouring coordinates to float and back, unless they are
  // stored.
  volatile float rounded[3];
  for (int k = 0; k < 3; ++k) rounded[k] = static_cast<float>(p[k]);
  return {rounded[0], rounded[1], rounded[2]};
}

}  // namespace sdm::simplify
