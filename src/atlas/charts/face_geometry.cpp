#include "atlas/charts/face_geometry.h"

#include <limits>

#include "core/parallel.h"
#include "mesh/topology.h"

namespace sdm::atlas {
namespace {

constexpr std::size_t kGrain = 4096;

std::vector<std::array<std::uint32_t, 3>> face_neighbours(const Mesh& mesh) {
  const mesh::Topology topology = mesh::build_topology(mesh.positions.size(), mesh.triangles);
  std::vector<std::array<std::uint32_t, 3>> neighbours(mesh.triangles.size(), {kNone, kNone, kNone});
  parallel_for(neighbours.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (topology.ignored(f)) continue;
      for (int k = 0; k < 3; ++k) {
        const auto faces = topology.edge_faces(topology.face_edges[f][k]);
        if (faces.size() == 2) neighbours[f][k] = faces[0] == f ? faces[1] : faces[0];
      }
    }
  });
  return neighbours;
}

}  // namespace

Vec3 face_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  std::array<Vec3, 3> edges = {b - a, c - b, a - c};
  if (cross(edges[0], edges[2]) == Vec3{}) return {};
  // The scale keeps squares of small lengths from underflow.
  double scale = 0;
  for (const Vec3& e : edges)
    for (const double x : e) scale = std::max(scale, std::abs(x));
  for (Vec3& e : edges) e = {e[0] / scale, e[1] / scale, e[2] / scale};

  int longest = 0;
  for (int k = 1; k < 3; ++k)
    if (squared_norm(edges[k]) > squared_norm(edges[longest])) longest = k;
  const Vec3 along = normalized(edges[longest]);
  // The height, orthogonalised twice against the longest edge: once does not suffice where it nearly
  // vanishes.
  Vec3 height = edges[(longest + 1) % 3];
  for (int pass = 0; pass < 2; ++pass) height = height - dot(height, along) * along;
  return normalized(cross(along, normalized(height)));
}

FaceGeometry face_geometry(const Mesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  FaceGeometry faces;
  faces.normal.resize(count);
  faces.area.resize(count);
  faces.centroid.resize(count);
  const auto measure = [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto [i, j, k] = mesh.triangles[f];
      const Vec3 &a = mesh.positions[i], &b = mesh.positions[j], &c = mesh.positions[k];
      faces.normal[f] = face_normal(a, b, c);
      faces.centroid[f] = (1.0 / 3) * (a + b + c);
      if (faces.normal[f] != Vec3{})
        faces.area[f] = std::max(0.5 * norm(cross(b - a, c - a)), std::numeric_limits<double>::min());
    }
  };
  parallel_for(count, kGrain, measure);
  faces.neighbours = face_neighbours(mesh);
  return faces;
}

}  // namespace sdm::atlas
