#include "mesh/regions.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "core/vec.h"

namespace sdm {
namespace {

constexpr std::size_t kGrain = 256;  // blocks

// The next free lane of the blocks from `first` on, opening a block when the last is full.
template <typename Block>
std::pair<Block&, int> next_lane(std::vector<Block>& blocks, std::size_t first) {
  if (blocks.size() == first || blocks.back().count == Block::kWidth) blocks.emplace_back();
  return {blocks.back(), static_cast<int>(blocks.back().count++)};
}

void set3(float (&rows)[3][RegionBlock::kWidth], int lane, const Vec3& v) {
  for (int k = 0; k < 3; ++k) rows[k][lane] = static_cast<float>(v[k]);
}

// The plane through p with this normal, as (normal, normal·p).
void set_plane(float (&rows)[4][RegionBlock::kWidth], int lane, const Vec3& normal, const Vec3& p) {
  for (int k = 0; k < 3; ++k) rows[k][lane] = static_cast<float>(normal[k]);
  rows[3][lane] = static_cast<float>(dot(normal, p));
}

// For each vertex, the neighbours over edges, in compressed rows.
struct Neighbours {
  std::vector<std::uint32_t> offsets, vertices;
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t v) const {
    return {vertices.data() + offsets[v], vertices.data() + offsets[v + 1]};
  }
};

Neighbours vertex_neighbours(std::size_t vertex_count, const Topology& topology) {
  Neighbours n{std::vector<std::uint32_t>(vertex_count + 1, 0),
               std::vector<std::uint32_t>(2 * topology.edges.size())};
  for (const auto& [a, b] : topology.edges) ++n.offsets[a + 1], ++n.offsets[b + 1];
  for (std::size_t v = 0; v < vertex_count; ++v) n.offsets[v + 1] += n.offsets[v];
  std::vector<std::uint32_t> next(n.offsets.begin(), n.offsets.end() - 1);
  for (const auto& [a, b] : topology.edges) n.vertices[next[a]++] = b, n.vertices[next[b]++] = a;
  return n;
}

// Neighbours of a vertex on all its sides: each the most opposed to the sum of those chosen before, so that
// no half of the directions around it is left open, in which the cone would reach far out. With fewer than
// kRays, the first stands for the rest.
std::array<std::uint32_t, VertexBlock::kRays> spread_neighbours(std::uint32_t vertex,
                                                                std::span<const std::uint32_t> neighbours,
                                                                std::span<const Vec3> positions) {
  std::array<std::uint32_t, VertexBlock::kRays> chosen;
  Vec3 sum{};
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    std::uint32_t best = neighbours[0];
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t neighbour : neighbours) {
      if (std::find(chosen.begin(), chosen.begin() + k, neighbour) != chosen.begin() + k) continue;
      const double along = dot(normalized(positions[neighbour] - positions[vertex]), sum);
      if (along < least) least = along, best = neighbour;
    }
    chosen[k] = best;
    sum += normalized(positions[best] - positions[vertex]);
  }
  return chosen;
}

Vec3 face_normal(const Triangle& t, std::span<const Vec3> p) {
  return normalized(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
}

// In single precision the walls of a face thinner than this, in the unit frame, would close in nothing. Its
// edges stand for it: no point of it is farther from them than half of this.
constexpr double kThin = 1e-6;

bool thin(const Triangle& t, std::span<const Vec3> p) {
  double longest = 0;
  for (int k = 0; k < 3; ++k) longest = std::max(longest, norm(p[t[(k + 1) % 3]] - p[t[k]]));
  return !(norm(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]])) > kThin * longest);
}

void fill(FaceBlock& block, std::span<const Vec3> p, std::span<const Triangle> triangles) {
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const Triangle& t = triangles[block.face[i]];
    const Vec3 normal = face_normal(t, p);
    const bool no_prism = thin(t, p);
    set_plane(block.plane, i, normal, p[t[0]]);
    for (int k = 0; k < 3; ++k) {
      const Vec3 inward = normalized(cross(normal, p[t[(k + 1) % 3]] - p[t[k]]));
      set_plane(block.wall[k], i, inward, p[t[k]]);
      // A wall that nothing is on the inner side of.
      if (no_prism) block.wall[k][3][i] = std::numeric_limits<float>::infinity();
    }
  }
}

void fill(EdgeBlock& block, std::span<const Vec3> p, std::span<const Triangle> triangles,
          const Topology& topology) {
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const auto [a, b] = topology.edges[block.edge[i]];
    const Vec3 along = p[b] - p[a], direction = normalized(along);
    set3(block.start, i, p[a]);
    set3(block.direction, i, direction);
    block.length[i] = static_cast<float>(norm(along));
    const auto faces = topology.edge_faces(block.edge[i]);
    for (std::size_t j = 0; j < 2; ++j) {
      const Triangle& t = triangles[faces[std::min(j, faces.size() - 1)]];
      const Vec3 opposite = p[t[0] ^ t[1] ^ t[2] ^ a ^ b] - p[a];  // the corner that is neither a nor b
      // No wall towards a face that its edges stand for.
      const Vec3 inward = thin(t, p) ? Vec3{} : normalized(opposite - dot(opposite, direction) * direction);
      set_plane(block.wall[j], i, inward, p[a]);
    }
  }
}

void fill(VertexBlock& block, std::span<const Vec3> p) {
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const Vec3& v = p[block.vertex[i]];
    set3(block.point, i, v);
    for (int k = 0; k < VertexBlock::kRays; ++k)
      set3(block.ray[k], i, normalized(p[block.neighbour[k][i]] - v));
  }
}

}  // namespace

Regions build_regions(std::span<const Vec3> unit_positions, std::span<const Triangle> triangles,
                      const Topology& topology, const AabbTree& tree) {
  Regions regions;
  std::vector<std::uint8_t> edge_taken(topology.edges.size(), 0), vertex_taken(unit_positions.size(), 0);
  const auto add_leaf_start = [&] {
    regions.leaves.push_back({static_cast<std::uint32_t>(regions.faces.size()),
                              static_cast<std::uint32_t>(regions.edges.size()),
                              static_cast<std::uint32_t>(regions.vertices.size())});
    return regions.leaves.back();
  };
  for (const AabbTree::Node& node : tree.nodes) {
    if (!node.leaf()) continue;
    const Regions::Leaf start = add_leaf_start();
    for (std::uint32_t item = node.first; item < node.first + node.count; ++item) {
      const std::uint32_t face = tree.items[item];
      auto [faces, face_lane] = next_lane(regions.faces, start.faces);
      faces.face[face_lane] = face;
      for (int k = 0; k < 3; ++k) {
        if (const std::uint32_t edge = topology.face_edges[face][k]; !std::exchange(edge_taken[edge], 1)) {
          auto [edges, lane] = next_lane(regions.edges, start.edges);
          edges.face[lane] = face;
          edges.edge[lane] = edge;
        }
        if (const std::uint32_t vertex = triangles[face][k]; !std::exchange(vertex_taken[vertex], 1)) {
          auto [vertices, lane] = next_lane(regions.vertices, start.vertices);
          vertices.face[lane] = face;
          vertices.vertex[lane] = vertex;
        }
      }
    }
  }
  add_leaf_start();

  const Neighbours neighbours = vertex_neighbours(unit_positions.size(), topology);
  parallel_for(regions.vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      VertexBlock& block = regions.vertices[i];
      for (std::uint32_t lane = 0; lane < block.count; ++lane) {
        const std::uint32_t vertex = block.vertex[lane];
        const auto chosen = spread_neighbours(vertex, neighbours.of(vertex), unit_positions);
        for (int k = 0; k < VertexBlock::kRays; ++k) block.neighbour[k][lane] = chosen[k];
      }
    }
  });
  refit(regions, unit_positions, triangles, topology);
  return regions;
}

void refit(Regions& regions, std::span<const Vec3> unit_positions, std::span<const Triangle> triangles,
           const Topology& topology) {
  parallel_for(regions.faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) fill(regions.faces[i], unit_positions, triangles);
  });
  parallel_for(regions.edges.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) fill(regions.edges[i], unit_positions, triangles, topology);
  });
  parallel_for(regions.vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) fill(regions.vertices[i], unit_positions);
  });
}

}  // namespace sdm
