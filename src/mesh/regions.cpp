#include "mesh/regions.h"

#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "core/vec.h"

namespace sdm {
namespace {

constexpr std::size_t kGrain = 1024;  // faces

// Calls body(i) for all i below count, on all cores.
template <class Body>
void for_each(std::size_t count, const Body& body) {
  parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

void set3(float (&to)[3], const Vec3& v) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(v[k]);
}

// The plane through p with this normal, as (normal, normal·p).
void set_plane(float (&to)[4], const Vec3& normal, const Vec3& p) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(normal[k]);
  to[3] = static_cast<float>(dot(normal, p));
}

// In single precision the walls of a face thinner than this, in the unit frame, would close in nothing. Its
// edges stand for it: no point of it is farther from them than half of this.
constexpr double kThin = 1e-6;

// A face's normal: unit length if it has an area, and whether it is thin.
struct FaceNormal {
  Vec3 unit;
  bool thin;
};

FaceNormal face_normal(const Triangle& t, std::span<const Vec3> p) {
  const Vec3 sides[3] = {p[t[1]] - p[t[0]], p[t[2]] - p[t[1]], p[t[0]] - p[t[2]]};
  const Vec3 normal = cross(sides[0], sides[1]);
  double longest = 0;
  for (const Vec3& side : sides) longest = std::max(longest, squared_norm(side));
  return {normalized(normal), !(squared_norm(normal) > kThin * kThin * longest)};
}

// Whether the faces around the sites that a face owns, all turned alike, enclose them.
std::uint8_t encloses(const RegionSource& s, const Regions& regions, std::size_t owner) {
  if (!s.orientation.orientable) return 0;
  const auto inner = [&](std::uint32_t edge) { return s.topology.edge_faces(edge).size() == 2; };
  const Regions::Owner &own = regions.owners[owner], &next = regions.owners[owner + 1];
  for (std::uint32_t e = own.edges; e < next.edges; ++e)
    if (!inner(regions.edges[e].edge)) return 0;
  for (std::uint32_t v = own.vertices; v < next.vertices; ++v)
    for (const std::uint32_t face : s.vertex_faces.of(regions.vertices[v].vertex))
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t vertex = regions.vertices[v].vertex;
        const bool at_vertex = s.triangles[face][k] == vertex || s.triangles[face][(k + 1) % 3] == vertex;
        if (at_vertex && !inner(s.topology.face_edges[face][k])) return 0;
      }
  return 1;
}

// Neighbours of a vertex on all its sides: each the most opposed to the sum of those chosen before, so that
// no half of the directions around it is left open, in which the cone would reach far out. With fewer than
// kRays, the first stands for the rest.
std::array<std::uint32_t, VertexRegion::kRays> spread_neighbours(const RegionSource& s,
                                                                 std::uint32_t vertex) {
  const auto direction = [&](std::uint32_t neighbour) {
    return normalized(s.positions[neighbour] - s.positions[vertex]);
  };
  const auto faces = s.vertex_faces.of(vertex);
  std::array<std::uint32_t, VertexRegion::kRays> chosen;
  Vec3 sum{};
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    std::uint32_t best = k > 0 ? chosen[0] : kNone;
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t face : faces)
      for (const std::uint32_t neighbour : s.triangles[face]) {
        if (neighbour == vertex ||
            std::find(chosen.begin(), chosen.begin() + k, neighbour) != chosen.begin() + k)
          continue;
        const double along = dot(direction(neighbour), sum);
        if (along < least || best == kNone) least = along, best = neighbour;
      }
    chosen[k] = best;
    sum += direction(best);
  }
  return chosen;
}

void fill(FaceRegion& region, const RegionSource& s, std::uint32_t face, const FaceNormal& normal) {
  const Triangle& t = s.triangles[face];
  set_plane(region.plane, normal.unit, s.positions[t[0]]);
  for (int k = 0; k < 3; ++k) {
    const Vec3 &a = s.positions[t[k]], &b = s.positions[t[(k + 1) % 3]];
    set_plane(region.wall[k], normalized(cross(normal.unit, b - a)), a);
    // A wall that nothing is on the inner side of.
    if (normal.thin) region.wall[k][3] = std::numeric_limits<float>::infinity();
  }
}

void fill(EdgeRegion& region, const RegionSource& s, std::span<const FaceNormal> normals) {
  const auto [a, b] = s.topology.edges[region.edge];
  const Vec3 along = s.positions[b] - s.positions[a], direction = normalized(along);
  set3(region.start, s.positions[a]);
  set3(region.direction, direction);
  region.length = static_cast<float>(norm(along));
  const auto faces = s.topology.edge_faces(region.edge);
  for (std::size_t j = 0; j < 2; ++j) {
    const std::uint32_t face = faces[std::min(j, faces.size() - 1)];
    const Triangle& t = s.triangles[face];
    const Vec3 opposite = s.positions[t[0] ^ t[1] ^ t[2] ^ a ^ b] - s.positions[a];  // neither a nor b
    // No wall towards a face that its edges stand for.
    const Vec3 inward =
        normals[face].thin ? Vec3{} : normalized(opposite - dot(opposite, direction) * direction);
    set_plane(region.wall[j], inward, s.positions[a]);
  }
}

void fill(VertexRegion& region, const RegionSource& s,
          const std::array<std::uint32_t, VertexRegion::kRays>& neighbours) {
  const Vec3& v = s.positions[region.vertex];
  set3(region.point, v);
  for (int k = 0; k < VertexRegion::kRays; ++k)
    set3(region.ray[k], normalized(s.positions[neighbours[k]] - v));
}

// The centre of the smallest circle about a triangle: of its longest side where the angle across is obtuse.
Vec3 enclosing_centre(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 corner[3] = {a, b, c};
  double square[3];  // of the sides across
  for (int k = 0; k < 3; ++k) square[k] = squared_norm(corner[(k + 2) % 3] - corner[(k + 1) % 3]);
  Vec3 sum{};
  double total = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 &left = corner[(k + 1) % 3], &right = corner[(k + 2) % 3];
    const double acute = square[(k + 1) % 3] + square[(k + 2) % 3] - square[k];
    if (!(acute > 0)) return 0.5 * (left + right);
    sum += (square[k] * acute) * corner[k];
    total += square[k] * acute;
  }
  return (1 / total) * sum;
}

// Steeper than this counts as open.
constexpr double kSteepest = 20;
constexpr float kOpen = 1e18f;

void fill(FaceBounds& bounds, int lane, const RegionSource& s, const Regions& regions, std::size_t owner,
          std::span<const FaceNormal> normals) {
  const Regions::Owner &own = regions.owners[owner], &next = regions.owners[owner + 1];
  const Triangle& t = s.triangles[own.face];
  const Vec3 centre = enclosing_centre(s.positions[t[0]], s.positions[t[1]], s.positions[t[2]]);
  const FaceNormal& normal = normals[own.face];
  double radius = 0, slope = 0;
  for (const std::uint32_t v : t) radius = std::max(radius, norm(s.positions[v] - centre));
  bool open = normal.thin || regions.enclosed[owner] == 0;
  const auto include = [&](std::uint32_t face) {
    const FaceNormal& other = normals[face];
    const bool turned = s.orientation.turned[face] != s.orientation.turned[own.face];
    const double along = turned ? -dot(normal.unit, other.unit) : dot(normal.unit, other.unit);
    const double across = norm(cross(normal.unit, other.unit));
    open |= other.thin || !(across < kSteepest * along);
    if (!open) slope = std::max(slope, across / along);
  };
  for (std::uint32_t e = own.edges; e < next.edges && !open; ++e)
    for (const std::uint32_t face : s.topology.edge_faces(regions.edges[e].edge)) include(face);
  for (std::uint32_t v = own.vertices; v < next.vertices && !open; ++v)
    for (const std::uint32_t face : s.vertex_faces.of(regions.vertices[v].vertex)) include(face);
  constexpr double kRounding = 1e-6;  // of single precision
  for (int k = 0; k < 3; ++k) {
    bounds.centre[k][lane] = static_cast<float>(centre[k]);
    bounds.normal[k][lane] = static_cast<float>(normal.unit[k]);
  }
  bounds.radius[lane] = static_cast<float>((1 + kRounding) * radius);
  bounds.slope[lane] = open ? kOpen : static_cast<float>((1 + kRounding) * slope + kRounding);
}

}  // namespace

Regions build_regions(const RegionSource& s, const AabbTree& tree) {
  Regions regions;
  const std::size_t count = tree.items.size();
  for (const AabbTree::Node& node : tree.nodes)
    if (node.leaf()) regions.leaves.push_back(node.first);
  regions.leaves.push_back(static_cast<std::uint32_t>(count));

  std::vector<std::uint32_t> position(s.triangles.size());
  for_each(count, [&](std::size_t i) { position[tree.items[i]] = static_cast<std::uint32_t>(i); });
  // Whether the face at position i owns a site of these faces.
  const auto owns = [&](std::size_t i, std::span<const std::uint32_t> faces) {
    return std::ranges::all_of(faces, [&](std::uint32_t face) { return position[face] >= i; });
  };
  const auto for_owned = [&](std::size_t i, const auto& on_edge, const auto& on_vertex) {
    const std::uint32_t face = tree.items[i];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t edge = s.topology.face_edges[face][k], vertex = s.triangles[face][k];
      if (owns(i, s.topology.edge_faces(edge))) on_edge(edge);
      if (owns(i, s.vertex_faces.of(vertex))) on_vertex(vertex);
    }
  };
  regions.owners.resize(count + 1);
  for_each(count, [&](std::size_t i) {
    Regions::Owner& next = regions.owners[i + 1];
    for_owned(
        i, [&](std::uint32_t) { ++next.edges; }, [&](std::uint32_t) { ++next.vertices; });
  });
  for (std::size_t i = 0; i < count; ++i) {
    regions.owners[i].face = tree.items[i];
    regions.owners[i + 1].edges += regions.owners[i].edges;
    regions.owners[i + 1].vertices += regions.owners[i].vertices;
  }
  regions.faces.resize(count);
  regions.edges.resize(regions.owners[count].edges);
  regions.vertices.resize(regions.owners[count].vertices);
  regions.neighbours.resize(regions.vertices.size());
  regions.enclosed.resize(count);
  regions.bounds.resize(regions.leaves.size() - 1);
  for_each(count, [&](std::size_t i) {
    auto [face, edge_at, vertex_at] = regions.owners[i];
    for_owned(
        i, [&](std::uint32_t edge) { regions.edges[edge_at++].edge = edge; },
        [&](std::uint32_t vertex) {
          regions.neighbours[vertex_at] = spread_neighbours(s, vertex);
          regions.vertices[vertex_at++].vertex = vertex;
        });
    regions.enclosed[i] = encloses(s, regions, i);
  });
  refit(regions, s);
  return regions;
}

void refit(Regions& regions, const RegionSource& s) {
  std::vector<FaceNormal> normals(s.triangles.size());
  for_each(s.triangles.size(), [&](std::size_t f) { normals[f] = face_normal(s.triangles[f], s.positions); });
  for_each(regions.bounds.size(), [&](std::size_t leaf) {
    const std::uint32_t first = regions.leaves[leaf], end = regions.leaves[leaf + 1];
    for (std::uint32_t i = first; i < end; ++i) {
      const Regions::Owner &own = regions.owners[i], &next = regions.owners[i + 1];
      fill(regions.faces[i], s, own.face, normals[own.face]);
      for (std::uint32_t e = own.edges; e < next.edges; ++e) fill(regions.edges[e], s, normals);
      for (std::uint32_t v = own.vertices; v < next.vertices; ++v)
        fill(regions.vertices[v], s, regions.neighbours[v]);
      fill(regions.bounds[leaf], static_cast<int>(i - first), s, regions, i, normals);
    }
  });
}

}  // namespace sdm
