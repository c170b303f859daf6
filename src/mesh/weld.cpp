// Boundary edges are matched in pairs, the closest ones first, and the vertices at their ends are united.
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <new>
#include <numeric>
#include <tuple>

#include "core/disjoint_sets.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/point_triangle.h"
#include "geometry/unit_frame.h"
#include "geometry/vec.h"
#include "mesh/topology.h"
#include "tree/visit.h"

namespace sdm {
namespace mesh {
namespace {

constexpr double kMostOfLength = 0.25;    // of the shorter edge: gaps longer than this are no rounding
constexpr double kMostOfDiagonal = 1e-3;  // without a tolerance
constexpr std::uint32_t kLeafSize = 4;
constexpr std::size_t kWeldGrain = 256;

struct BoundaryEdge {
  std::uint32_t face;
  std::array<std::uint32_t, 2> ends;  // as the face has them
};

std::vector<BoundaryEdge> boundary_edges(std::span<const Triangle> triangles, const Topology& topology) {
  std::vector<BoundaryEdge> boundary;
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    const auto faces = topology.edge_faces(e);
    if (faces.size() != 1) continue;
    const auto& edges = topology.face_edges[faces[0]];
    const int k = edges[0] == e ? 0 : edges[1] == e ? 1 : 2;
    const Triangle& t = triangles[faces[0]];
    boundary.push_back({faces[0], {t[k], t[(k + 1) % 3]}});
  }
  return boundary;
}

// Two boundary edges, the first one with the smaller number; `opposite`: they run in opposite directions.
struct Match {
  double distance;  // the larger one of the distances of their ends
  std::uint32_t edge, partner;
  bool opposite;

  friend bool operator<(const Match& a, const Match& b) {
    return std::tie(b.opposite, a.distance, a.edge, a.partner) <
           std::tie(a.opposite, b.distance, b.edge, b.partner);
  }
  friend bool operator==(const Match&, const Match&) = default;
};

// Finds the edges that may be joined.
class Matching {
 public:
  Matching(const Mesh& mesh, std::span<const BoundaryEdge> edges, double most)
      : mesh_(mesh),
        edges_(edges),
        most_(most),
        frame_(UnitFrame::of(bounds(mesh))),
        matched_(edges.size(), 0) {
    std::vector<Box> boxes(edges.size());
    std::vector<std::uint32_t> indices(edges.size());
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
      boxes[e].lower = boxes[e].upper = frame_.to_unit(middle(e));
      indices[e] = e;
    }
    tree_ = tree::build_aabb_tree(boxes, std::move(indices), kLeafSize);
  }

  // Pairs of edges, each edge in one of them: the best ones first, then those of the edges that are left.
  std::vector<Match> run(const Progress& progress) {
    constexpr int kMostRounds = 16;  // many edges in one place may each leave one pair a round
    std::vector<Match> all;
    for (int round = 0; round < kMostRounds; ++round) {
      const std::size_t before = all.size();
      for (const Match& match : best_matches(progress)) {
        if (matched_[match.edge] || matched_[match.partner]) continue;
        matched_[match.edge] = matched_[match.partner] = 1;
        all.push_back(match);
      }
      if (all.size() == before) break;
    }
    return all;
  }

  // Whether the faces are the sides of a wall thinner than twice the tolerance: they turn their backs on each
  // other, and a corner that is no end of the edges is near the other face.
  bool across_a_wall(const Match& match, double tolerance) const {
    constexpr double kTurned = -0.5;  // cosine of the angle of the normals
    const Corners a = corners(match.edge), b = corners(match.partner);
    const double turned = dot(normal(a), normal(b));
    if ((match.opposite ? turned : -turned) > kTurned) return false;
    return thickness(match.edge, b) < 2 * tolerance || thickness(match.partner, a) < 2 * tolerance;
  }

 private:
  const Vec3& at(std::uint32_t vertex) const { return mesh_.positions[vertex]; }
  Vec3 middle(std::uint32_t e) const { return 0.5 * (at(edges_[e].ends[0]) + at(edges_[e].ends[1])); }
  double length(std::uint32_t e) const { return norm(at(edges_[e].ends[1]) - at(edges_[e].ends[0])); }
  Corners corners(std::uint32_t e) const {
    const auto& [a, b, c] = mesh_.triangles[edges_[e].face];
    return {at(a), at(b), at(c)};
  }
  static Vec3 normal(const Corners& t) { return normalized(cross(t[1] - t[0], t[2] - t[0])); }

  // The distance of the corner opposite to an edge from another face.
  double thickness(std::uint32_t e, const Corners& face) const {
    const auto& [begin, end] = edges_[e].ends;
    for (const std::uint32_t v : mesh_.triangles[edges_[e].face])
      if (v != begin && v != end) return norm(closest_on_triangle(at(v), face) - at(v));
    return 0;
  }

  // That of each edge that is left, each once, the best ones first.
  std::vector<Match> best_matches(const Progress& progress) const {
    std::vector<Match> best(edges_.size(), Match{kInfinity, 0, kNone, false});
    parallel_for(edges_.size(), kWeldGrain, progress, "weld", [&](std::size_t begin, std::size_t end) {
      for (std::size_t e = begin; e < end; ++e)
        if (!matched_[e]) best[e] = match_of(static_cast<std::uint32_t>(e));
    });
    std::erase_if(best, [](const Match& match) { return match.partner == kNone; });
    std::ranges::sort(best, std::less<>());
    best.erase(std::ranges::unique(best).begin(), best.end());
    return best;
  }

  Match match_of(std::uint32_t e) const {
    const auto [a, b] = edges_[e].ends;
    const double most = std::min(most_, kMostOfLength * length(e));
    const Vec3 from = frame_.to_unit(middle(e));
    Match best{kInfinity, e, kNone, false};
    const double limit = frame_.scale * most;
    // The middles of two edges are at most as far apart as their ends.
    const auto bound = [&](const tree::FloatBox& box) { return squared_norm(gap(box, from)); };
    const auto enter = [&](double squared) {
      const double reach = best.opposite ? std::min(limit, frame_.scale * best.distance) : limit;
      return squared <= reach * reach * (1 + 1e-6);
    };
    const auto leaf = [&](std::uint32_t node) {
      for (const std::uint32_t f : tree_.items_of(node)) {
        if (matched_[f] || edges_[f].face == edges_[e].face) continue;
        const auto [c, d] = edges_[f].ends;
        const double opposite = std::max(norm(at(a) - at(d)), norm(at(b) - at(c))),
                     alike = std::max(norm(at(a) - at(c)), norm(at(b) - at(d)));
        const Match found{std::min(opposite, alike), std::min(e, f), std::max(e, f), opposite <= alike};
        if (found.distance > std::min(most, kMostOfLength * length(f)) ||
            across_a_wall(found, found.distance))
          continue;
        if (best.partner == kNone || found < best) best = found;
      }
    };
    tree::visit(tree_, tree::NearestFirst{bound, enter, leaf});
    return best;
  }

  const Mesh& mesh_;
  std::span<const BoundaryEdge> edges_;
  double most_;
  UnitFrame frame_;
  std::vector<std::uint8_t> matched_;
  tree::AabbTree tree_;  // of the middles
};

// Sets of vertices that become one, of which no two are of one face.
class VertexSets {
 public:
  VertexSets(const Mesh& mesh, const Topology& topology)
      : mesh_(mesh),
        faces_(vertex_faces(mesh.positions.size(), mesh.triangles, topology)),
        sets_(mesh.positions.size()),
        next_(mesh.positions.size()),
        size_(mesh.positions.size(), 1) {
    std::iota(next_.begin(), next_.end(), 0u);
  }

  std::uint32_t of(std::uint32_t vertex) { return sets_.find(vertex); }

  // Whether two vertices are in one set, or may be.
  bool may_unite(std::uint32_t a, std::uint32_t b) {
    a = of(a);
    b = of(b);
    if (a == b) return true;
    if (size_[b] < size_[a]) std::swap(a, b);
    std::uint32_t v = a;  // the sets are circular lists
    do {
      for (const std::uint32_t f : faces_.of(v))
        for (const std::uint32_t corner : mesh_.triangles[f])
          if (of(corner) == b) return false;
      v = next_[v];
    } while (v != a);
    return true;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = of(a);
    b = of(b);
    if (a == b) return;
    const std::uint32_t size = size_[a] + size_[b];
    std::swap(next_[a], next_[b]);
    sets_.unite(a, b);
    size_[of(a)] = size;
  }

 private:
  const Mesh& mesh_;
  VertexFaces faces_;
  DisjointSets sets_;
  std::vector<std::uint32_t> next_, size_;
};

// Joins the ends of two edges, unless that joins two vertices of one face. Returns whether both are joined.
bool join(VertexSets& sets, const BoundaryEdge& edge, const BoundaryEdge& partner, bool opposite) {
  const auto [a, b] = edge.ends;
  const auto [c, d] = partner.ends;
  const std::uint32_t first = opposite ? d : c, second = opposite ? c : d;
  if (!sets.may_unite(a, first) || !sets.may_unite(b, second)) return false;
  sets.unite(a, first);
  if (!sets.may_unite(b, second)) return false;
  sets.unite(b, second);
  return true;
}

void apply(VertexSets& sets, Welded& welded) {
  Mesh& mesh = welded.mesh;
  welded.vertex.resize(mesh.positions.size());
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const std::uint32_t to = welded.vertex[v] = sets.of(v);
    if (to == v) continue;
    ++welded.joined_vertices;
    welded.largest_move = std::max(welded.largest_move, norm(mesh.positions[to] - mesh.positions[v]));
    mesh.positions[v] = mesh.positions[to];
  }
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t)
      if (v < welded.vertex.size()) v = welded.vertex[v];
}

// The vertices of boundary edges that lie on another such edge.
std::size_t count_t_junctions(const Mesh& mesh, std::span<const BoundaryEdge> edges, double tolerance) {
  const UnitFrame frame = UnitFrame::of(bounds(mesh));
  std::vector<Box> boxes(edges.size());
  std::vector<std::uint32_t> indices(edges.size()), vertices;
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    indices[e] = e;
    for (const std::uint32_t v : edges[e].ends) {
      extend(boxes[e], frame.to_unit(mesh.positions[v]));
      vertices.push_back(v);
    }
  }
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  const tree::AabbTree tree = tree::build_aabb_tree(boxes, std::move(indices), kLeafSize);
  const double reach = frame.scale * tolerance;
  std::vector<std::uint8_t> on_edge(vertices.size(), 0);
  parallel_for(vertices.size(), kWeldGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& p = mesh.positions[vertices[i]];
      const Vec3 in_frame = frame.to_unit(p);
      const auto enter = [&](const tree::Subtree& below) {
        return !on_edge[i] && squared_norm(gap(tree.box(below.root), in_frame)) <= reach * reach;
      };
      const auto leaf = [&](std::uint32_t node) {
        for (const std::uint32_t e : tree.items_of(node)) {
          const Vec3 &a = mesh.positions[edges[e].ends[0]], &b = mesh.positions[edges[e].ends[1]];
          const auto within = [&](const Vec3& q) { return norm(p - q) <= tolerance; };
          if (!within(a) && !within(b) && within(closest_on_segment(p, a, b))) on_edge[i] = 1;
        }
      };
      tree::visit(tree, tree::InOrder{enter, leaf});
    }
  });
  return static_cast<std::size_t>(std::ranges::count(on_edge, 1));
}

}  // namespace
}  // namespace mesh

Welded weld(const Mesh& mesh, const WeldOptions& options) try {
  validate(mesh);
  check_options(options);
  const double size = diagonal(bounds(mesh));
  const double most = options.tolerance.value_or(mesh::kMostOfDiagonal * size);
  const mesh::Topology topology = mesh::build_topology(mesh.positions.size(), mesh.triangles);
  const auto edges = mesh::boundary_edges(mesh.triangles, topology);

  mesh::Matching matching(mesh, edges, most);
  const std::vector<mesh::Match> matches = matching.run(options.progress);
  const auto nearer = [](const mesh::Match& a, const mesh::Match& b) { return a.distance < b.distance; };
  Welded welded{{}, mesh, {}};
  mesh::VertexSets sets(mesh, topology);
  if (!matches.empty()) {
    const double widest = std::ranges::max_element(matches, nearer)->distance;
    for (const mesh::Match& match : matches) {
      if (matching.across_a_wall(match, options.tolerance.value_or(widest))) continue;
      if (mesh::join(sets, edges[match.edge], edges[match.partner], match.opposite))
        welded.tolerance = std::max(welded.tolerance, match.distance);
    }
  }
  mesh::apply(sets, welded);

  const mesh::Topology left = mesh::build_topology(mesh.positions.size(), welded.mesh.triangles);
  const auto open = mesh::boundary_edges(welded.mesh.triangles, left);
  welded.boundary_edges = open.size();
  // Edges that do not meet end to end differ by rounding as those do that were joined.
  constexpr double kLeastOfDiagonal = 1e-6;
  welded.t_junctions = mesh::count_t_junctions(
      welded.mesh, open, options.tolerance.value_or(std::max(welded.tolerance, kLeastOfDiagonal * size)));
  return welded;
} catch (const std::bad_alloc&) {
  throw out_of_memory("welding the mesh");
}

}  // namespace sdm
