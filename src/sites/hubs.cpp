#include "sites/hubs.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "core/cancellation.h"
#include "core/parallel.h"
#include "geometry/boxes.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "sites/intersecting_faces.h"
#include "tree/aabb_tree.h"

namespace sdm::sites {
namespace {

using tree::AabbTree;
using tree::FloatBox;
using tree::NodePair;
using Visit = std::function<bool(std::span<const FacePair>)>;

// A vertex or an edge of more faces is a hub. Fewer than that make at most so many pairs of each face.
constexpr std::size_t kMany = 256;

// A face, seen from nowhere, from a vertex or around an edge. Faces with a hub in common are left to the view
// from that hub.
struct Item {
  std::array<std::uint32_t, 3> hubs;  ///< sorted; kNone for the rest
  std::uint32_t face = 0;
  FloatBox box{};
};

bool in_common(const std::array<std::uint32_t, 3>& a, const std::array<std::uint32_t, 3>& b) {
  return std::ranges::any_of(
      a, [&](std::uint32_t hub) { return hub != kNone && std::ranges::find(b, hub) != b.end(); });
}

// Pairs of nodes that together cover all pairs whose boxes overlap: enough of them to share among threads.
std::vector<NodePair> divided(const AabbTree& tree, std::vector<NodePair> pairs) {
  constexpr std::size_t kEnough = 512;
  for (std::size_t before = 0; pairs.size() < kEnough && pairs.size() != before;) {
    before = pairs.size();
    std::vector<NodePair> next;
    for (const NodePair& pair : pairs) {
      if (leaves(tree, pair))
        next.push_back(pair);
      else
        for_each_child_pair(tree, pair, [&](const NodePair& below) {
          if (overlap(tree, below)) next.push_back(below);
        });
    }
    pairs = std::move(next);
  }
  return pairs;
}

// What is left of the work of a search.
struct Budget {
  std::uint64_t left = kAllPairs;  ///< pairs of faces
  std::atomic<bool> go_on{true};   ///< until visit() returns false
  std::atomic<bool> all{true};     ///< whether no pair was left out
};

// The pairs of faces of two leaves.
class LeafPairs {
 public:
  explicit LeafPairs(const Mesh& mesh) : mesh_(mesh) {}

  /// Those whose boxes overlap, until the next call.
  std::span<const FacePair> near(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                                 bool same) {
    set_boxes(first, first_);
    if (!same) set_boxes(second, second_);
    const std::vector<Box>& of_second = same ? first_ : second_;
    pairs_.clear();
    for (std::size_t i = 0; i < first.size(); ++i)
      for (std::size_t j = same ? i + 1 : 0; j < second.size(); ++j)
        if (sdm::overlap(first_[i], of_second[j])) pairs_.push_back({first[i], second[j]});
    return pairs_;
  }

 private:
  void set_boxes(std::span<const std::uint32_t> faces, std::vector<Box>& boxes) {
    boxes.clear();
    for (const std::uint32_t face : faces) {
      Box box;
      for (const std::uint32_t v : mesh_.triangles[face]) extend(box, mesh_.positions[v]);
      boxes.push_back(box);
    }
  }

  const Mesh& mesh_;
  std::vector<Box> first_, second_;
  std::vector<FacePair> pairs_;
};

// The number of pairs of faces of two leaves.
std::uint64_t count_of(const AabbTree& tree, const NodePair& leaves) {
  const std::uint64_t first = tree.items_of(leaves[0]).size(), second = tree.items_of(leaves[1]).size();
  return leaves[0] == leaves[1] ? first * (first - 1) / 2 : first * second;
}

// How many pairs of faces may be looked at for each pair of nodes: all, or the first `left` ones together.
std::vector<std::uint64_t> allowances(const AabbTree& tree, const std::vector<NodePair>& pairs,
                                      std::uint64_t left) {
  std::vector<std::uint64_t> allowed(pairs.size(), left);
  if (left == kAllPairs) return allowed;
  constexpr std::size_t kAtOnce = 64;  // so that counting ends soon after there are enough
  for (std::size_t first = 0; first < pairs.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, pairs.size() - first);
    if (left > 0)
      parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
        Poll due(1024);
        for (std::size_t i = first + begin; i < first + end; ++i) {
          std::uint64_t counted = 0;
          const auto enter = [&](const NodePair& pair) {
            due();
            return counted <= left && overlap(tree, pair);
          };
          const auto count_leaves = [&](const NodePair& leaves) { counted += count_of(tree, leaves); };
          visit_pairs(tree, pairs[i], tree::InOrder{enter, count_leaves});
          allowed[i] = counted;
        }
      });
    for (std::size_t i = first; i < first + count; ++i) {
      allowed[i] = std::min(allowed[i], left);
      left -= allowed[i];
    }
  }
  return allowed;
}

// Lowers `left` by the pairs that were looked at; `all` becomes false if these were not all.
void visit_overlapping(const Mesh& mesh, const AabbTree& tree, const std::vector<NodePair>& roots,
                       const Progress& progress, Budget& budget, const Visit& visit) {
  const std::vector<NodePair> pairs = divided(tree, roots);
  const std::vector<std::uint64_t> allowed = allowances(tree, pairs, budget.left);
  parallel_for(pairs.size(), 1, progress, "self-intersections", [&](std::size_t begin, std::size_t end) {
    Poll due(128);
    LeafPairs pairs_of_leaves(mesh);
    for (std::size_t i = begin; i < end; ++i) {
      std::uint64_t left = allowed[i];
      bool enough = true;
      const auto enter = [&](const NodePair& pair) {
        due();
        return enough && budget.go_on.load(std::memory_order_relaxed) && overlap(tree, pair);
      };
      const auto visit_leaves = [&](const NodePair& leaves) {
        const std::uint64_t count = count_of(tree, leaves);
        if (budget.left != kAllPairs) {
          enough = count <= left;
          if (!enough) return budget.all.store(false, std::memory_order_relaxed);
          left -= count;
        }
        if (!visit(pairs_of_leaves.near(tree.items_of(leaves[0]), tree.items_of(leaves[1]),
                                        leaves[0] == leaves[1])))
          budget.go_on = false;
      };
      visit_pairs(tree, pairs[i], tree::InOrder{enter, visit_leaves});
    }
  });
  if (budget.left == kAllPairs) return;
  for (const std::uint64_t count : allowed) budget.left -= count;
}

// The trees of all sets of hubs, one after another in one.
struct Forest {
  AabbTree tree;
  std::vector<std::uint32_t> roots;
  std::vector<Box> boxes;  ///< of the roots
  std::vector<std::array<std::uint32_t, 3>> hubs;

  explicit Forest(std::vector<Item> items) {
    std::ranges::sort(items, {}, [](const Item& item) { return std::pair(item.hubs, item.face); });
    std::vector<FloatBox> all;
    for (const Item& item : items) all.push_back(item.box);
    for (std::size_t begin = 0; begin < items.size();) {
      std::size_t end = begin;
      while (end < items.size() && items[end].hubs == items[begin].hubs) ++end;
      std::vector<std::uint32_t> indices(end - begin);
      std::iota(indices.begin(), indices.end(), static_cast<std::uint32_t>(begin));
      constexpr std::uint32_t kLeafFaces = 8;
      add(tree::build_aabb_tree(std::span<const FloatBox>(all), std::move(indices), kLeafFaces));
      hubs.push_back(items[begin].hubs);
      begin = end;
    }
    for (std::uint32_t& item : tree.items) item = items[item].face;
  }

  // Faces without a hub are paired with each other too.
  [[nodiscard]] std::vector<NodePair> root_pairs() const {
    std::vector<NodePair> pairs;
    for (std::size_t g = 0; g < roots.size(); ++g)
      if (hubs[g][0] == kNone) pairs.push_back({roots[g], roots[g]});
    Sweep sweep;
    for (const auto& [a, b] : sweep.near_pairs(boxes, 0))
      if (!in_common(hubs[a], hubs[b])) pairs.push_back({roots[a], roots[b]});
    return pairs;
  }

 private:
  void add(const AabbTree& more) {
    roots.push_back(static_cast<std::uint32_t>(tree.nodes.size()));
    const FloatBox& box = more.box(0);
    boxes.push_back({{box.lower[0], box.lower[1], box.lower[2]}, {box.upper[0], box.upper[1], box.upper[2]}});
    append(tree, more);
  }
};

class Hubs {
 public:
  explicit Hubs(const SitesData& sites) : s_(sites), is_hub_(sites.mesh.positions.size(), 0) {
    for (std::uint32_t v = 0; v < is_hub_.size(); ++v)
      if (s_.vertex_faces.of(v).size() > kMany) {
        vertices_.push_back(v);
        is_hub_[v] = 1;
      }
    if (vertices_.empty()) return;
    for (std::uint32_t e = 0; e < s_.topology.edges.size(); ++e)
      if (is_hub_edge(e)) edges_.push_back(e);
  }

  [[nodiscard]] bool none() const { return vertices_.empty(); }

  void visit(Budget& budget, const Progress& progress, const Visit& visit) const {
    const auto among = [&](const std::vector<Item>& items, const Progress& reporting, const auto& handled) {
      const Forest forest(items);
      visit_overlapping(
          s_.mesh, forest.tree, forest.root_pairs(), reporting, budget, [&](std::span<const FacePair> pairs) {
            std::vector<FacePair> left(pairs.begin(), pairs.end());
            std::erase_if(left, [&](const FacePair& pair) { return !handled(pair[0], pair[1]); });
            return visit(left);
          });
    };
    std::vector<Item> items;
    for (const std::uint32_t face : s_.tree.items) items.push_back({hubs_of(face), face, box_of(face)});
    among(items, progress, [](auto, auto) { return true; });
    for (const std::uint32_t hub : vertices_) {
      if (!budget.go_on) return;
      items.clear();
      for (const std::uint32_t face : s_.vertex_faces.of(hub))
        items.push_back({hub_edges_of(face, hub), face, arc_of(face, hub)});
      // The first of several hubs that two faces share visits them.
      among(items, {}, [&](std::uint32_t a, std::uint32_t b) { return first_in_common(a, b) == hub; });
    }
    for (const std::uint32_t edge : edges_) {
      if (!budget.go_on) return;
      items.clear();
      for (const std::uint32_t face : s_.topology.edge_faces(edge))
        items.push_back({{kNone, kNone, kNone}, face, direction_of(face, edge)});
      among(items, {}, [](auto, auto) { return true; });
    }
  }

 private:
  [[nodiscard]] bool is_hub_edge(std::uint32_t edge) const {
    return edge != kNone && s_.topology.edge_faces(edge).size() > kMany;
  }
  [[nodiscard]] std::array<std::uint32_t, 3> hubs_of(std::uint32_t face) const {
    std::array hubs{kNone, kNone, kNone};
    for (int k = 0; k < 3; ++k)
      if (const std::uint32_t v = s_.mesh.triangles[face][k]; is_hub_[v]) hubs[k] = v;
    std::ranges::sort(hubs);
    return hubs;
  }
  [[nodiscard]] std::uint32_t first_in_common(std::uint32_t a, std::uint32_t b) const {
    const std::array of_a = hubs_of(a), of_b = hubs_of(b);
    for (const std::uint32_t hub : of_a)
      if (hub != kNone && std::ranges::find(of_b, hub) != of_b.end()) return hub;
    return kNone;
  }
  // The edges at a vertex that are hubs.
  [[nodiscard]] std::array<std::uint32_t, 3> hub_edges_of(std::uint32_t face, std::uint32_t vertex) const {
    std::array hubs{kNone, kNone, kNone};
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t edge = s_.topology.face_edges[face][k];
      if (!is_hub_edge(edge)) continue;
      const auto& ends = s_.topology.edges[edge];
      if (ends[0] == vertex || ends[1] == vertex) hubs[k] = edge;
    }
    std::ranges::sort(hubs);
    return hubs;
  }

  [[nodiscard]] FloatBox box_of(std::uint32_t face) const {
    Box box;
    for (const std::uint32_t v : s_.mesh.triangles[face]) extend(box, s_.frame.to_unit(s_.mesh.positions[v]));
    return FloatBox::around(box);
  }

  // What contains every direction: of faces too small or too large to compute theirs.
  static FloatBox everywhere() { return {{-2, -2, -2}, {2, 2, 2}}; }
  static FloatBox widened(Box box, double by) {
    if (!(by < 1) || !finite(box.lower) || !finite(box.upper)) return everywhere();
    for (int k = 0; k < 3; ++k) {
      box.lower[k] -= by;
      box.upper[k] += by;
    }
    return FloatBox::around(box);
  }

  // The directions from a vertex to the points of a face: an arc between two unit vectors, which is nowhere
  // farther from their chord than at its middle.
  [[nodiscard]] FloatBox arc_of(std::uint32_t face, std::uint32_t vertex) const {
    Box box;
    Vec3 sum{};
    for (const std::uint32_t v : s_.mesh.triangles[face])
      if (v != vertex) {
        const Vec3 direction = unit_vector(s_.mesh.positions[v] - s_.mesh.positions[vertex]);
        sum += 0.5 * direction;
        extend(box, direction);
      }
    return widened(box, 1 - norm(sum) + kDoubleRounding);
  }

  // The direction of a face from an edge, across it: from its third corner, of which little remains where the
  // face is thin.
  [[nodiscard]] FloatBox direction_of(std::uint32_t face, std::uint32_t edge) const {
    const auto [p, q] = s_.topology.edges[edge];
    const Vec3 along = unit_vector(s_.mesh.positions[q] - s_.mesh.positions[p]);
    for (const std::uint32_t v : s_.mesh.triangles[face])
      if (v != p && v != q) {
        const Vec3 to = unit_vector(s_.mesh.positions[v] - s_.mesh.positions[p]);
        const Vec3 across = to - dot(to, along) * along;
        Box box;
        extend(box, (1 / norm(across)) * across);
        return widened(box, kDoubleRounding / norm(across));
      }
    return everywhere();
  }

  // NaN for a vector of length 0.
  static Vec3 unit_vector(const Vec3& v) {
    const double largest = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
    const Vec3 scaled = (1 / largest) * v;
    return (1 / norm(scaled)) * scaled;
  }

  const SitesData& s_;
  std::vector<std::uint8_t> is_hub_;             // of each vertex
  std::vector<std::uint32_t> vertices_, edges_;  // hubs
};

}  // namespace

// Two faces that share a corner and another point share the segment between them, so that their arcs, as seen
// from the corner, meet. Two that share an edge and another point lie in one plane, on the same side of it.
bool for_each_near_pair(const SitesData& sites, std::uint64_t most, const Progress& progress,
                        const Visit& visit) {
  if (sites.tree.nodes.empty()) return true;
  Budget budget{.left = most};
  if (const Hubs hubs(sites); !hubs.none())
    hubs.visit(budget, progress, visit);
  else
    visit_overlapping(sites.mesh, sites.tree, {{0, 0}}, progress, budget, visit);
  return budget.all;
}

}  // namespace sdm::sites
