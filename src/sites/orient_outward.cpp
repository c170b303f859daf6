#include "sites/orient_outward.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>

#include "core/cancellation.h"
#include "core/parallel.h"
#include "geometry/triangle_pair.h"
#include "sites/intersecting_faces.h"
#include "tree/fold.h"

namespace sdm::sites {
namespace {

constexpr std::size_t kShellPart = 4096;

struct Shell {
  std::uint32_t component;
  std::span<const std::uint32_t> faces;
  bool inward = false;  ///< as flipped by the orientation, the faces enclose a negative volume
};

// Six times the volume. A corner of the shell as origin preserves the precision of small shells. Summed in
// parts that do not depend on the number of threads.
double volume(const Shell& shell, const inside::FaceTree& faces, std::span<const std::uint8_t> flipped) {
  const std::span<const Vec3> p = faces.positions;
  const Vec3& origin = p[faces.triangles[shell.faces.front()][0]];
  thread_local std::vector<double> parts_of_this_thread;  // a thread waiting for a loop starts no other shell
  std::vector<double>& parts = parts_of_this_thread;
  parts.assign((shell.faces.size() + kShellPart - 1) / kShellPart, 0);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const std::uint32_t f : shell.faces.subspan(i * kShellPart)
                                       .first(std::min(kShellPart, shell.faces.size() - i * kShellPart))) {
        const Triangle& t = faces.triangles[f];
        const double v = dot(p[t[0]] - origin, cross(p[t[1]] - origin, p[t[2]] - origin));
        parts[i] += flipped[f] ? -v : v;
      }
  });
  return std::accumulate(parts.begin(), parts.end(), 0.0);
}

// Labels each node of the tree with the shell that its faces belong to, or kNone if they belong to several.
void label_nodes(const tree::AabbTree& tree, std::span<const std::uint32_t> component,
                 std::vector<std::uint32_t>& label) {
  label.resize(tree.nodes.size());
  for_each_bottom_up(
      tree,
      [&](std::uint32_t leaf) {
        const auto items = tree.items_of(leaf);
        label[leaf] = component[items.front()];
        for (const std::uint32_t face : items)
          if (component[face] != label[leaf]) label[leaf] = kNone;
      },
      [&](std::uint32_t node, std::uint32_t left, std::uint32_t right) {
        label[node] = label[left] == label[right] ? label[left] : kNone;
      });
}

using ShellNode = std::array<std::uint32_t, 2>;  // a shell, and a node of the tree

// The nodes that together have all faces of each shell: the largest ones of its faces only, and leaves that
// it shares with others. Sorted.
void find_nodes_of_shells(const tree::AabbTree& tree, std::span<const std::uint32_t> component,
                          std::span<const std::uint32_t> label, std::vector<ShellNode>& nodes) {
  nodes.clear();
  for_each_bottom_up(
      tree,
      [&](std::uint32_t leaf) {
        if (label[leaf] != kNone) return;
        for (const std::uint32_t face : tree.items_of(leaf)) nodes.push_back({component[face], leaf});
      },
      [&](std::uint32_t node, std::uint32_t left, std::uint32_t right) {
        if (label[node] != kNone) return;
        for (const std::uint32_t child : {left, right})
          if (label[child] != kNone) nodes.push_back({label[child], child});
      });
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
}

std::span<const ShellNode> nodes_of(std::uint32_t shell, std::span<const ShellNode> nodes) {
  const auto [begin, end] =
      std::ranges::equal_range(nodes, shell, {}, [](const ShellNode& n) { return n[0]; });
  return {begin, end};
}

// Finds the other shells around a corner of the shell, in ascending order: those that a ray from it crosses
// an odd number of times.
void find_around(const Shell& shell, const inside::FaceTree& faces, std::span<const std::uint32_t> component,
                 std::span<const std::uint32_t> faces_at, std::vector<std::uint32_t>& around) {
  around.clear();
  // One of few faces: a ray from where many meet would meet the boxes of all of them.
  constexpr std::size_t kTried = 8;
  std::uint32_t vertex = faces.triangles[shell.faces.front()][0];
  for (const std::uint32_t face : shell.faces.first(std::min(kTried, shell.faces.size())))
    for (const std::uint32_t v : faces.triangles[face])
      if (faces_at[v] < faces_at[vertex]) vertex = v;
  const Vec3& corner = faces.positions[vertex];
  for_each_crossing(faces, faces.frame.to_unit(corner), [&](std::uint32_t face) {
    if (component[face] != shell.component) around.push_back(component[face]);
  });
  std::ranges::sort(around);
  auto end = around.begin();
  for (auto next = around.begin(); next != around.end();) {
    const auto same = std::find_if(next, around.end(), [&](std::uint32_t other) { return other != *next; });
    if ((same - next) % 2 == 1) *end++ = *next;
    next = same;
  }
  around.erase(end, around.end());
}

// Removes from `others` the shells that have a point in common with this one, whose faces are below `nodes`.
void remove_intersecting(const Shell& shell, const inside::FaceTree& faces,
                         std::span<const std::uint32_t> component, std::span<const std::uint32_t> label,
                         std::span<const ShellNode> nodes, std::vector<std::uint32_t>& others) {
  const tree::AabbTree& tree = faces.tree;
  const FaceSoup mesh{faces.positions, faces.triangles, tree};
  const auto wanted = [&](std::uint32_t other) { return std::ranges::binary_search(others, other); };
  Poll due(128);
  for (const auto& [unused, node] : nodes) {
    if (others.empty()) return;
    const auto enter = [&](const tree::NodePair& pair) {
      due();
      return (label[pair[1]] == kNone || wanted(label[pair[1]])) && overlap(tree, pair);
    };
    const auto visit_leaves = [&](const tree::NodePair& leaves) {
      for (const std::uint32_t f : tree.items_of(leaves[0]))
        for (const std::uint32_t g : tree.items_of(leaves[1]))
          if (component[f] == shell.component && wanted(component[g]) &&
              triangles_intersect(mesh.corners(f), mesh.corners(g)))
            others.erase(std::ranges::lower_bound(others, component[g]));
    };
    visit_pairs(tree, {node, 0}, tree::InOrder{enter, visit_leaves});
  }
}

}  // namespace

Shells find_shells(const mesh::Orientation& orientation) {
  return make_rows<std::uint32_t>(orientation.first_face.size(), [&](const auto& put) {
    for (std::uint32_t f = 0; f < orientation.component.size(); ++f)
      if (orientation.component[f] != kNone) put(orientation.component[f], f);
  });
}

// A shell is hollow, a cavity, if it lies inside an odd number of those that it does not intersect.
void orient_outward(const inside::FaceTree& faces, const mesh::Orientation& orientation, const Shells& shells,
                    Array<std::uint8_t>& inverted) {
  inverted = orientation.flipped;
  const std::span<const std::uint32_t> component = orientation.component;
  const bool several = shells.size() > 1;
  // Kept by the thread, so that a refit allocates nothing.
  thread_local std::vector<std::vector<std::uint32_t>> around_of_this_thread;
  thread_local std::vector<std::uint32_t> label_of_this_thread;
  thread_local std::vector<ShellNode> nodes_of_this_thread;
  thread_local std::vector<std::uint32_t> faces_at_of_this_thread;
  std::vector<std::uint32_t>& faces_at = faces_at_of_this_thread;  // each vertex
  std::vector<std::vector<std::uint32_t>>& around = around_of_this_thread;
  std::vector<std::uint32_t>& label = label_of_this_thread;
  std::vector<ShellNode>& nodes = nodes_of_this_thread;
  if (several && around.size() < shells.size()) around.resize(shells.size());
  if (several) {
    faces_at.assign(faces.positions.size(), 0);
    for (const Triangle& t : faces.triangles)
      for (const std::uint32_t v : t) ++faces_at[v];
  }
  std::atomic<bool> nested{false};
  const auto shell_of = [&](std::size_t s) { return Shell{static_cast<std::uint32_t>(s), shells.of(s)}; };
  parallel_for(several ? shells.size() : 0, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      find_around(shell_of(s), faces, component, faces_at, around[s]);
      if (!around[s].empty()) nested = true;
    }
  });
  if (nested) {
    label_nodes(faces.tree, component, label);
    find_nodes_of_shells(faces.tree, component, label, nodes);
  }
  parallel_for(shells.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      Shell shell = shell_of(s);
      shell.inward = volume(shell, faces, orientation.flipped) < 0;
      if (several && !around[s].empty())
        remove_intersecting(shell, faces, component, label, nodes_of(shell.component, nodes), around[s]);
      const bool hollow = several && around[s].size() % 2 == 1;
      if (shell.inward != hollow)
        for (const std::uint32_t f : shell.faces) inverted[f] ^= 1;
    }
  });
}

}  // namespace sdm::sites
