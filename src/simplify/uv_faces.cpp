#include "simplify/uv_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "core/disjoint_sets.h"

namespace sdm::simplify {
namespace {

using Edge = std::array<std::uint32_t, 2>;

Triangle least_first(Triangle t) {
  std::ranges::rotate(t, std::ranges::min_element(t));
  return t;
}

std::uint64_t key_of(std::uint32_t from, std::uint32_t to) {
  return std::uint64_t{from} << 32 | to;
}

/// The faces at directed edges, and which positions are connected.
class Edges {
 public:
  Edges(const Wedges& wedges, const std::vector<Triangle>& triangles) : wedges_(wedges) {
    faces_.reserve(3 * triangles.size());
    for (std::uint32_t f = 0; f < triangles.size(); ++f) add(triangles[f], f);
  }

  void add(const Triangle& t, std::uint32_t f) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const auto [at, is_new] = faces_.try_emplace(key_of(a, b), f);
      if (!is_new) at->second = kNone;  // of several faces
      ++positions_[key_of(wedges_.vertex[a], wedges_.vertex[b])];
    }
  }
  void remove(const Triangle& t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (const auto at = faces_.find(key_of(a, b)); at != faces_.end() && at->second != kNone)
        faces_.erase(at);  // an edge of several faces stays one: no flip crosses it
      --positions_[key_of(wedges_.vertex[a], wedges_.vertex[b])];
    }
  }
  [[nodiscard]] std::uint32_t face_at(std::uint32_t a, std::uint32_t b) const {
    const auto found = faces_.find(key_of(a, b));
    return found == faces_.end() ? kNone : found->second;
  }
  [[nodiscard]] bool connects(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t p = wedges_.vertex[a], q = wedges_.vertex[b];
    for (const std::uint64_t key : {key_of(p, q), key_of(q, p)})
      if (const auto found = positions_.find(key); found != positions_.end() && found->second > 0)
        return true;
    return p == q;
  }

 private:
  const Wedges& wedges_;
  std::unordered_map<std::uint64_t, std::uint32_t> faces_, positions_;
};

Vec3 normal_of(const Wedges& wedges, const Triangle& t) {
  const Vec3& a = wedges.positions[wedges.vertex[t[0]]];
  return cross(wedges.positions[wedges.vertex[t[1]]] - a, wedges.positions[wedges.vertex[t[2]]] - a);
}

// How a face winds in the texture: 1, −1, or 0 if it is so low that rounding to float may change it.
int turn_in_texture(const Wedges& wedges, const Triangle& triangle) {
  constexpr double kLeastHeight = 0x1p-22;  // four times what rounding moves a coordinate in [0, 1]
  const std::array<Vec2, 3> uvs = uvs_of(wedges, triangle);
  double longest = 0, scale = 1;
  for (int k = 0; k < 3; ++k) {
    const Vec2 side = uvs[(k + 1) % 3] - uvs[k];
    longest = std::max(longest, std::hypot(side[0], side[1]));
    scale = std::max({scale, std::abs(uvs[k][0]), std::abs(uvs[k][1])});
  }
  const double area = cross(uvs[1] - uvs[0], uvs[2] - uvs[0]);
  if (!(std::abs(area) > kLeastHeight * scale * longest)) return 0;
  return area > 0 ? 1 : -1;
}

}  // namespace

void find_turns(Wedges& wedges) {
  wedges.turns.resize(wedges.vertex.size());
  DisjointSets charts(wedges.vertex.size());
  for (const Triangle& t : wedges.triangles)
    for (const std::uint32_t w : {t[1], t[2]}) charts.unite(t[0], w);
  constexpr int kBoth = 3;  // as bits: 1 of faces with a positive area, 2 with a negative one
  std::vector<std::uint8_t> windings(wedges.vertex.size());
  for (const Triangle& t : wedges.triangles)
    if (const int turn = turn_in_texture(wedges, t); turn != 0)
      windings[charts.find(t[0])] |= turn > 0 ? 1 : 2;
  for (std::uint32_t w = 0; w < windings.size(); ++w)
    if (const int both = windings[charts.find(w)]; both != kBoth)
      wedges.turns[w] = both == 1 ? 1 : both == 2 ? -1 : 0;
  for (const Triangle& t : wedges.triangles)
    if (turn_in_texture(wedges, t) == 0) wedges.flat.push_back(least_first(t));
  std::ranges::sort(wedges.flat);
}

bool is_wrong_in_texture(const Wedges& wedges, const Triangle& triangle) {
  const int turn = turn_in_texture(wedges, triangle), of_chart = wedges.turns[triangle[0]];
  if (turn != 0 && turn * of_chart >= 0) return false;
  return !std::ranges::binary_search(wedges.flat, least_first(triangle));
}

std::vector<std::uint32_t> mend_in_texture(const Wedges& wedges, std::vector<Triangle>& triangles) {
  if (wedges.uvs.empty()) return {};
  const auto is_wrong = [&](const Triangle& t) { return is_wrong_in_texture(wedges, t); };
  std::vector<std::uint32_t> wrong;
  for (std::uint32_t f = 0; f < triangles.size(); ++f)
    if (is_wrong(triangles[f])) wrong.push_back(f);
  if (wrong.empty()) return {};
  Edges edges(wedges, triangles);
  // The two faces after the flip of the edge from corner k of a face: its other corner, and that of the face
  // beyond it, become the ends of the edge.
  const auto flip = [&](std::uint32_t f, int k) {
    const std::uint32_t a = triangles[f][k], b = triangles[f][(k + 1) % 3], c = triangles[f][(k + 2) % 3];
    const std::uint32_t g = edges.face_at(b, a);
    if (g == kNone || edges.face_at(a, b) != f) return false;
    const Triangle beyond = triangles[g];
    const std::uint32_t d = beyond[0] != a && beyond[0] != b   ? beyond[0]
                            : beyond[1] != a && beyond[1] != b ? beyond[1]
                                                               : beyond[2];
    if (edges.connects(c, d)) return false;
    const Triangle first{a, d, c}, second{d, b, c};
    if (is_wrong(first) || is_wrong(second)) return false;
    const Vec3 normal = normal_of(wedges, triangles[f]) + normal_of(wedges, beyond);
    if (!(dot(normal_of(wedges, first), normal) > 0 && dot(normal_of(wedges, second), normal) > 0))
      return false;
    edges.remove(triangles[f]);
    edges.remove(beyond);
    triangles[f] = first;
    triangles[g] = second;
    edges.add(first, f);
    edges.add(second, g);
    return true;
  };
  for (std::size_t before = wrong.size() + 1; wrong.size() < before;) {
    before = wrong.size();
    std::erase_if(wrong, [&](std::uint32_t f) {
      return !is_wrong(triangles[f]) || flip(f, 0) || flip(f, 1) || flip(f, 2);
    });
  }
  return wrong;
}

}  // namespace sdm::simplify
