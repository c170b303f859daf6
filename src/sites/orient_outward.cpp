#include "sites/orient_outward.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/geometry/triangle_pair.h"
#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "sites/intersecting_faces.h"

namespace sdm::sites {
namespace {

constexpr std::size_t kGrain = 4096;

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
  parts.assign((shell.faces.size() + kGrain - 1) / kGrain, 0);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const std::uint32_t f :
           shell.faces.subspan(i * kGrain).first(std::min(kGrain, shell.faces.size() - i * kGrain))) {
        const Triangle& t = faces.triangles[f];
        const double v = dot(p[t[0]] - origin, cross(p[t[1]] - origin, p[t[2]] - origin));
        parts[i] += flipped[f] ? -v : v;
      }
  });
  return std::accumulate(parts.begin(), parts.end(), 0.0);
}

// Pairs of shells, the smaller number first, in lexicographic order.
using ShellPairs = std::vector<std::array<std::uint32_t, 2>>;

void insert(ShellPairs& pairs, std::uint32_t a, std::uint32_t b) {
  const std::array pair{std::min(a, b), std::max(a, b)};
  const auto at = std::ranges::lower_bound(pairs, pair);
  if (at == pairs.end() || *at != pair) pairs.insert(at, pair);
}
bool contains(const ShellPairs& pairs, std::uint32_t a, std::uint32_t b) {
  return std::ranges::binary_search(pairs, std::array{std::min(a, b), std::max(a, b)});
}

// Finds the shells that have a point in common.
void find_intersecting(const inside::FaceTree& faces, std::span<const std::uint32_t> component,
                       ShellPairs& pairs) {
  pairs.clear();
  const hierarchy::AabbTree& tree = faces.tree;
  // Of each node the shell that its faces belong to, or kNone if they belong to several.
  thread_local std::vector<std::uint32_t> shells;
  std::vector<std::uint32_t>& shell = shells;
  shell.resize(tree.nodes.size());
  for_each_bottom_up(
      tree,
      [&](std::uint32_t leaf) {
        const auto items = tree.items_of(leaf);
        shell[leaf] = component[items.front()];
        for (const std::uint32_t face : items)
          if (component[face] != shell[leaf]) shell[leaf] = kNone;
      },
      [&](std::uint32_t node, std::uint32_t left, std::uint32_t right) {
        shell[node] = shell[left] == shell[right] ? shell[left] : kNone;
      });
  const FaceSoup mesh{faces.positions, faces.triangles, tree};
  traverse_pairs(
      tree, {0, 0},
      [&](const hierarchy::NodePair& pair) {
        const std::uint32_t a = shell[pair[0]], b = shell[pair[1]];
        if (a != kNone && b != kNone && (a == b || contains(pairs, a, b))) return false;
        return overlap(tree, pair);
      },
      [&](const hierarchy::NodePair& leaves) {
        for_each_face_pair(tree, leaves, [&](std::uint32_t f, std::uint32_t g) {
          const std::uint32_t a = component[f], b = component[g];
          if (a != b && !contains(pairs, a, b) && triangles_intersect(mesh.corners(f), mesh.corners(g)))
            insert(pairs, a, b);
        });
      });
}

// Whether the shell lies inside an odd number of those that it does not intersect.
bool hollow(const Shell& shell, const inside::FaceTree& faces, std::span<const std::uint32_t> component,
            const ShellPairs& intersecting) {
  const Vec3& corner = faces.positions[faces.triangles[shell.faces.front()][0]];
  bool odd = false;
  for_each_crossing(faces, faces.frame.to_unit(corner), [&](std::uint32_t face) {
    const std::uint32_t other = component[face];
    odd ^= other != shell.component && !contains(intersecting, shell.component, other);
  });
  return odd;
}

}  // namespace

Shells find_shells(const mesh::Orientation& orientation) {
  return make_rows<std::uint32_t>(orientation.first_face.size(), [&](const auto& put) {
    for (std::uint32_t f = 0; f < orientation.component.size(); ++f)
      if (orientation.component[f] != kNone) put(orientation.component[f], f);
  });
}

void orient_outward(const inside::FaceTree& faces, const mesh::Orientation& orientation, const Shells& shells,
                    std::vector<std::uint8_t>& inverted) {
  inverted = orientation.flipped;
  thread_local ShellPairs pairs_of_this_thread;
  ShellPairs& intersecting = pairs_of_this_thread;
  if (shells.size() > 1) find_intersecting(faces, orientation.component, intersecting);
  parallel_for(shells.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      Shell shell{static_cast<std::uint32_t>(s), shells.of(s)};
      shell.inward = volume(shell, faces, orientation.flipped) < 0;
      const bool is_hollow = shells.size() > 1 && hollow(shell, faces, orientation.component, intersecting);
      if (shell.inward != is_hollow)
        for (std::uint32_t f : shell.faces) inverted[f] ^= 1;
    }
  });
}

}  // namespace sdm::sites
