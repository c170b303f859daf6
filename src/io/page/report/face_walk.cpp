#include "io/page/report/face_walk.h"

#include <sdm/types.h>

#include <numeric>

namespace sdm::io {
namespace {

/// Corner 3 t + k of a triangle t starts the edge from its vertex k to the next one.
class Edges {
 public:
  Edges(std::span<const Triangle> triangles, std::size_t vertices)
      : triangles_(triangles), first_(vertices + 1), corners_(3 * triangles.size()) {
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t) ++first_[v];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    for (std::size_t c = corners_.size(); c-- > 0;)
      corners_[--first_[triangles[c / 3][c % 3]]] = static_cast<std::uint32_t>(c);
  }

  /// The first corner of an edge from `from` to `to` whose triangle was not seen; kNone if there is none.
  [[nodiscard]] std::uint32_t unseen(std::uint32_t from, std::uint32_t to,
                                     const std::vector<bool>& seen) const {
    for (std::uint32_t i = first_[from]; i < first_[from + 1]; ++i)
      if (const std::uint32_t c = corners_[i]; !seen[c / 3] && triangles_[c / 3][(c + 1) % 3] == to) return c;
    return kNone;
  }

 private:
  std::span<const Triangle> triangles_;
  std::vector<std::uint32_t> first_;  // of each vertex, its first place in `corners_`
  std::vector<std::uint32_t> corners_;
};

Triangle turned(const Triangle& t, std::uint32_t first) {
  return {t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
}

/// The vertex of a triangle that is on no side of the edge; kNone if the edge is not of it.
std::uint32_t opposite(const Triangle& t, std::uint32_t a, std::uint32_t b) {
  std::uint32_t other = kNone;
  int found = 0;
  for (const std::uint32_t v : t)
    if (v == a || v == b)
      ++found;
    else
      other = v;
  return found == 2 ? other : kNone;
}

}  // namespace

FaceWalk walk_over(std::span<const Triangle> triangles, std::size_t vertices) {
  const Edges edges(triangles, vertices);
  std::vector<bool> seen(triangles.size());
  std::vector<std::uint32_t> number(vertices, kNone), next;  // corners to go on from, the last one first
  FaceWalk walk;
  const auto add = [&](std::uint32_t face, Triangle triangle) {
    for (std::uint32_t& v : triangle) {
      if (number[v] == kNone) {
        number[v] = static_cast<std::uint32_t>(walk.vertex.size());
        walk.vertex.push_back(v);
      }
      v = number[v];
    }
    walk.triangles.push_back(triangle);
    walk.from.push_back(face);
  };
  const auto go = [&](std::uint32_t from, std::uint32_t to) {
    const std::uint32_t corner = edges.unseen(from, to, seen);
    if (corner == kNone) return;
    seen[corner / 3] = true;
    next.push_back(corner);
  };
  for (std::uint32_t start = 0; start < triangles.size(); ++start) {
    if (seen[start]) continue;
    seen[start] = true;
    next.push_back(3 * start);
    while (!next.empty()) {
      const std::uint32_t corner = next.back();
      next.pop_back();
      const Triangle t = turned(triangles[corner / 3], corner % 3);
      add(corner / 3, t);
      go(t[1], t[0]);  // none but at the start: the others came over this edge
      go(t[0], t[2]);
      go(t[2], t[1]);
    }
  }
  return walk;
}

std::vector<std::array<std::uint32_t, 3>> guesses_of(std::span<const Triangle> triangles) {
  std::vector<std::array<std::uint32_t, 3>> guesses;
  std::vector<std::uint32_t> last;  // the last triangle before this one of each vertex
  const auto guess = [&](const Triangle& t, std::uint32_t v) -> std::array<std::uint32_t, 3> {
    std::array<std::uint32_t, 2> others{kNone, kNone};
    int known = 0;
    for (const std::uint32_t u : t)
      if (u < v && known < 2) others[known++] = u;
    if (known == 0) return {v - 1, v - 1, v - 1};  // for the first one kNone
    for (int i = 0; known == 2 && i < 2; ++i)
      if (last[others[i]] != kNone)
        if (const std::uint32_t c = opposite(triangles[last[others[i]]], others[0], others[1]); c != kNone)
          return {others[0], others[1], c};
    return {others[0], others[0], others[0]};
  };
  for (std::uint32_t f = 0; f < triangles.size(); ++f) {
    for (const std::uint32_t v : triangles[f])
      if (v == guesses.size()) {
        guesses.push_back(guess(triangles[f], v));
        last.push_back(kNone);
      }
    for (const std::uint32_t v : triangles[f]) last[v] = f;
  }
  return guesses;
}

}  // namespace sdm::io
