#include <numeric>

#include "simplify/collapse_sequence.h"

namespace sdm::simplify {

CollapsedMesh after_collapses(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                              std::span<const CollapseOfEdge> collapses, const std::vector<bool>& held) {
  CollapsingMesh mesh(positions, triangles);
  std::vector<std::uint32_t> last(positions.size(), kNone);
  std::vector<bool> gone(positions.size());
  std::vector<MovedFace> moved;
  for (std::uint32_t i = 0; i < collapses.size(); ++i) {
    const CollapseOfEdge& c = collapses[i];
    if (!held.empty()) {
      if (held[i] || last[c.u] != c.before_u || last[c.v] != c.before_v) continue;
      if (gone[c.u] || gone[c.v]) continue;
      if (!mesh.keeps_topology(c.u, c.v) || !mesh.move(c.u, c.v, c.to, moved)) continue;
    }
    mesh.collapse(c.u, c.v, c.to);
    last[c.u] = i;
    gone[c.v] = true;
  }
  std::vector<bool> used(positions.size());
  for (std::uint32_t f = 0; f < triangles.size(); ++f)
    if (mesh.is_left(f))
      for (const std::uint32_t v : mesh.triangle(f)) used[v] = true;
  CollapsedMesh result{mesh.mesh(), {}, {}};
  for (std::uint32_t f = 0; f < triangles.size(); ++f)
    if (mesh.is_left(f)) result.faces.push_back(f);
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v]) result.last.push_back(last[v]);
  return result;
}

}  // namespace sdm::simplify
