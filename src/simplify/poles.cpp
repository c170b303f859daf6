#include "simplify/poles.h"

#include <algorithm>
#include <cmath>

#include "core/disjoint_sets.h"
#include "simplify/wedges.h"

namespace sdm::simplify {
namespace {

constexpr std::uint32_t kFewest = 3;  // wedges of a pole

/// A side of a face that begins at a vertex with many wedges, or ends there.
struct SideAtTip {
  std::uint32_t other, tip;  ///< wedges
  bool begins;               ///< at the tip
};

// Wedges of one vertex between which faces share an edge whose other end has one wedge.
DisjointSets fans(const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& vertex,
                  const std::vector<bool>& is_tip) {
  std::vector<SideAtTip> sides;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      if (!is_tip[vertex[t[k]]]) continue;
      sides.push_back({t[(k + 1) % 3], t[k], true});
      sides.push_back({t[(k + 2) % 3], t[k], false});
    }
  std::ranges::sort(sides, {}, [&](const SideAtTip& s) { return std::pair(s.other, vertex[s.tip]); });
  DisjointSets classes(vertex.size());
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const SideAtTip &a = sides[i - 1], &b = sides[i];
    const bool is_same = a.other == b.other && vertex[a.tip] == vertex[b.tip];
    if (is_same && a.begins != b.begins) classes.unite(a.tip, b.tip);
  }
  return classes;
}

// Removes wedges that no triangle has; their order stays. Returns the new number of each.
std::vector<std::uint32_t> remove_unused(Wedges& wedges) {
  std::vector<std::uint32_t> number(wedges.vertex.size(), kNone);
  for (const Triangle& t : wedges.triangles)
    for (const std::uint32_t w : t) number[w] = 0;
  std::uint32_t next = 0;
  const auto move = [&](auto& array, std::size_t from) {
    if (!array.empty()) array[next] = array[from];
  };
  for (std::size_t w = 0; w < number.size(); ++w) {
    if (number[w] == kNone) continue;
    move(wedges.vertex, w);
    move(wedges.uvs, w);
    move(wedges.regions, w);
    number[w] = next++;
  }
  wedges.vertex.resize(next);
  wedges.uvs.resize(next);
  if (!wedges.regions.empty()) wedges.regions.resize(next);
  for (Triangle& t : wedges.triangles)
    for (std::uint32_t& w : t) w = number[w];
  return number;
}

}  // namespace

void merge_poles(Wedges& wedges) {
  std::vector<std::uint32_t> count(wedges.positions.size());
  for (const std::uint32_t v : wedges.vertex) ++count[v];
  std::vector<bool> is_tip(count.size());
  for (std::size_t v = 0; v < count.size(); ++v) is_tip[v] = count[v] >= kFewest;
  if (std::ranges::count(is_tip, true) == 0) return;
  DisjointSets classes = fans(wedges.triangles, wedges.vertex, is_tip);
  std::vector<std::uint32_t> pole(wedges.vertex.size()), size(pole.size());
  for (std::uint32_t w = 0; w < pole.size(); ++w) ++size[pole[w] = classes.find(w)];
  for (std::uint32_t& p : pole)
    if (size[p] < kFewest) p = kNone;
  Poles found;
  for (const Triangle& t : wedges.triangles)
    for (int k = 0; k < 3; ++k)
      if (pole[t[k]] != kNone)
        found[pole[t[k]]].push_back({{t[(k + 1) % 3], t[(k + 2) % 3]}, wedges.uvs[t[k]]});
  if (found.empty()) return;
  const auto merged = [&](std::uint32_t w) { return pole[w] == kNone ? w : pole[w]; };
  for (Triangle& t : wedges.triangles)
    for (std::uint32_t& w : t) w = merged(w);
  const std::vector<std::uint32_t> number = remove_unused(wedges);
  for (auto& [wedge, corners] : found) {
    for (PoleCorner& corner : corners)
      for (std::uint32_t& w : corner.next) w = number[merged(w)];
    wedges.poles[number[wedge]] = std::move(corners);
  }
}

Vec2 uv_at_pole(const std::vector<PoleCorner>& corners, const std::array<std::uint32_t, 2>& next,
                const std::array<Vec2, 2>& sides) {
  const Vec2 middle = 0.5 * (sides[0] + sides[1]);
  const auto farness = [&](const PoleCorner& c) {
    return c.next == next ? -1 : std::hypot(c.uv[0] - middle[0], c.uv[1] - middle[1]);
  };
  return std::ranges::min_element(corners, {}, farness)->uv;
}

}  // namespace sdm::simplify
