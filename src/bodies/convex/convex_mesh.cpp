#include "bodies/convex/convex_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "geometry/predicates.h"
#include "geometry/triangle.h"
#include "geometry/vec.h"
#include "inside/angles/solid_angle.h"

namespace sdm::convex {
namespace {

constexpr double kMostSides = 1e6;           // squared side over area of a face whose normal is reliable
constexpr double kContinued = 1 - 1e-14;     // cosine of normals of faces in one plane
constexpr float kSingleHeightError = 1e-6F;  // of a height of coordinates of at most 1, in single precision

// The corner of a face that is not on the edge.
std::uint32_t apex_of(const Triangle& face, const std::array<std::uint32_t, 2>& edge) {
  for (const std::uint32_t vertex : face)
    if (vertex != edge[0] && vertex != edge[1]) return vertex;
  return face[0];
}

// Whether no edge is reflex, and whether the faces are oriented as their neighbours. `outward`: −1 if the
// mesh is inside out.
bool has_no_reflex_edge(const sites::SitesData& sites, int outward) {
  const Mesh& mesh = sites.mesh;
  for (std::size_t e = 0; e < sites.topology.edges.size(); ++e) {
    const std::span<const std::uint32_t> faces = sites.topology.edge_faces(e);
    const Corners corners = corners_of(mesh, faces[0]);
    const Vec3& apex = mesh.positions[apex_of(mesh.triangles[faces[1]], sites.topology.edges[e])];
    if (outward * orientation(corners[0], corners[1], corners[2], apex) > 0) return false;
  }
  return true;
}

int outward_of(const sites::SitesData& sites) {
  return sites.inverted[0] != 0 ? -1 : 1;
}

Vec3 mean_of_corners(const Mesh& mesh) {
  Vec3 mean{};
  double count = 0;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) {
      count += 1;
      mean = mean + (1 / count) * (mesh.positions[vertex] - mean);
    }
  return mean;
}

// Whether all faces see the centre from within, and once.
bool is_star_about(const Vec3& centre, const Mesh& mesh, int outward) {
  double angle = 0;
  for (std::size_t face = 0; face < mesh.triangles.size(); ++face) {
    const auto [a, b, c] = corners_of(mesh, face);
    if (outward * orientation(a, b, c, centre) >= 0) return false;
    angle += outward * inside::solid_angle(a - centre, b - centre, c - centre);
  }
  constexpr double kSphere = 4 * std::numbers::pi;
  return std::abs(angle - kSphere) < 0.1 * kSphere;
}

// Sets the normals of the faces. Returns the distance of the nearest plane of one from the centre.
double set_normals(ConvexMesh& convex, const Mesh& mesh) {
  double least = kInfinity;
  convex.normals.reserve(mesh.triangles.size());
  for (std::size_t face = 0; face < mesh.triangles.size(); ++face) {
    const auto [a, b, c] = corners_of(mesh, face);
    const Vec3 normal = convex.outward * normalized(cross(b - a, c - a));
    convex.normals.push_back(normal);
    least = std::min(least, std::abs(dot(normal, a - convex.centre)));
  }
  return least;
}

// The numbers of vertices of faces, kNone for others, and their edges.
void set_vertices(ConvexMesh& convex, const sites::SitesData& sites) {
  const Mesh& mesh = sites.mesh;
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const std::span<const std::uint32_t> faces = sites.vertex_faces.of(v);
    if (faces.empty()) continue;
    number[v] = static_cast<std::uint32_t>(convex.points.size());
    convex.points.push_back(mesh.positions[v]);
    convex.vertex.push_back(v);
    convex.first_face.push_back(faces.front());
  }
  convex.spokes = make_rows<Spoke>(convex.points.size(), [&](const auto& put) {
    for (std::size_t e = 0; e < sites.topology.edges.size(); ++e) {
      const auto& [a, b] = sites.topology.edges[e];
      const std::span<const std::uint32_t> faces = sites.topology.edge_faces(e);
      put(number[a], Spoke{number[b], {faces[0], faces[1]}});
      put(number[b], Spoke{number[a], {faces[0], faces[1]}});
    }
  });
}

bool has_reliable_normal(const Corners& face) {
  const auto& [a, b, c] = face;
  const double sides = std::max({squared_norm(b - a), squared_norm(c - b), squared_norm(a - c)});
  return sides < kMostSides * norm(cross(b - a, c - a));
}

// Faces that continue one with a smaller number, in a plane.
std::vector<bool> continuing_faces(const ConvexMesh& convex) {
  std::vector<bool> continuing(convex.normals.size(), false);
  for (const Spoke& spoke : convex.spokes.items) {
    const auto& [a, b] = spoke.faces;
    if (dot(convex.normals[a], convex.normals[b]) > kContinued) continuing[std::max(a, b)] = true;
  }
  return continuing;
}

void set_planes(ConvexMesh& convex, const Mesh& mesh) {
  const std::vector<bool> continuing = continuing_faces(convex);
  std::array<std::vector<float>, 3> planes;
  for (std::size_t face = 0; face < mesh.triangles.size(); ++face) {
    const Corners corners = corners_of(mesh, face);
    const Vec3& normal = convex.normals[face];
    const double distance = dot(normal, corners[0] - convex.centre);
    if (!has_reliable_normal(corners) || !(distance > 0)) return;
    if (continuing[face]) continue;
    for (int k = 0; k < 3; ++k) planes[k].push_back(static_cast<float>(convex.size / distance * normal[k]));
  }
  convex.planes = std::move(planes);
}

// The coordinates of vertices in single precision: number(i) is that of vertex i.
template <class Number>
std::array<std::vector<float>, 3> coordinates(const ConvexMesh& convex, std::size_t count,
                                              const Number& number) {
  const std::size_t padded = (count + ConvexMesh::kBlock - 1) / ConvexMesh::kBlock * ConvexMesh::kBlock;
  std::array<std::vector<float>, 3> along;
  for (int k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < padded; ++i)
      along[k].push_back(static_cast<float>(
          (convex.points[number(std::min(i, count - 1))][k] - convex.centre[k]) / convex.size));
  return along;
}

// Let a be a unit vector at a vertex v, and let all neighbours w be lower along it, −a·(w − v) ≥ s. If none
// is higher than v by more than e along a unit vector u, then along u + e / s · a none is higher at all, nor
// any other point p, as the mesh is convex: u·(p − v) ≤ e / s · |p − v|.
double least_sharpness(const ConvexMesh& convex) {
  double least = kInfinity;
  for (std::size_t v = 0; v < convex.points.size(); ++v) {
    Vec3 a{};
    for (const Spoke& spoke : convex.spokes.of(v))
      a = a + convex.normals[spoke.faces[0]] + convex.normals[spoke.faces[1]];
    a = normalized(a);
    for (const Spoke& spoke : convex.spokes.of(v))
      least = std::min(least, dot(a, convex.points[v] - convex.points[spoke.end]));
  }
  return least;
}

// Decides how farthest vertices are found.
void set_climbing(ConvexMesh& convex) {
  constexpr std::size_t kFew = 64;  // vertices that are all compared in less time
  convex.height_error = kSingleHeightError * convex.size + kFewRoundings * norm(convex.centre);
  convex.least_climb = kProductRounding * convex.size;
  if (convex.points.size() <= kFew) return;
  const double sharpness = least_sharpness(convex) - convex.least_climb;
  convex.climbs = sharpness > 0 && 2 * convex.least_climb / sharpness * convex.size < convex.height_error;
}

// The vertices that are farthest along directions spread over the sphere (a Fibonacci lattice), of meshes of
// which comparing all takes longer than climbing from the nearest of these.
void set_coarse(ConvexMesh& convex) {
  constexpr std::size_t kMany = 512, kDirections = 64;
  if (!convex.climbs || convex.points.size() < kMany) return;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / kDirections, r = std::sqrt(1 - z * z);
    const double turn = 2 * std::numbers::pi * static_cast<double>(i) / std::numbers::phi;
    const Vec3 u{r * std::cos(turn), r * std::sin(turn), z};
    const auto farthest =
        std::ranges::max_element(convex.points, {}, [&](const Vec3& p) { return dot(u, p); });
    convex.coarse_vertex.push_back(static_cast<std::uint32_t>(farthest - convex.points.begin()));
  }
  convex.coarse = coordinates(convex, convex.coarse_vertex.size(),
                              [&](std::size_t i) { return convex.coarse_vertex[i]; });
}

}  // namespace

bool is_convex(const sites::SitesData& sites) {
  const Mesh& mesh = sites.mesh;
  if (!sites.is_solid() || !sites.consistently_oriented || sites.orientation.first_face.size() != 1)
    return false;
  if (sites.topology.duplicate_faces + sites.topology.collapsed_faces > 0) return false;
  if (mesh.triangles.size() > 2 * kMostVertices) return false;
  const int outward = outward_of(sites);
  return has_no_reflex_edge(sites, outward) && is_star_about(mean_of_corners(mesh), mesh, outward);
}

std::unique_ptr<const ConvexMesh> recognise(const sites::SitesData& sites) {
  if (!is_convex(sites)) return {};
  const Mesh& mesh = sites.mesh;
  auto convex = std::make_unique<ConvexMesh>();
  convex->outward = outward_of(sites);
  convex->centre = mean_of_corners(mesh);
  const double radius = set_normals(*convex, mesh);
  Box box;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) extend(box, mesh.positions[vertex]);
  convex->size = diagonal(box);
  convex->lengths = convex->size + norm(convex->centre);
  convex->inner_radius = (1 - kDoubleRounding) * radius - kDoubleRounding * norm(convex->centre);
  set_vertices(*convex, sites);
  set_planes(*convex, mesh);
  convex->along = coordinates(*convex, convex->points.size(), [](std::size_t i) { return i; });
  set_climbing(*convex);
  set_coarse(*convex);
  return convex;
}

}  // namespace sdm::convex
