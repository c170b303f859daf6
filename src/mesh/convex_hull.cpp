// Quickhull (Barber, Dobkin & Huhdanpaa 1996) with exact predicates. Whether a point sees a face is decided
// exactly, and points in its plane do not: the faces that a point sees are then connected, and no edge of
// their outline is on a line with it, so that all new faces have an area.
#include <sdm/error.h>
#include <sdm/mesh_edit.h>
#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "core/memory.h"
#include "geometry/predicates.h"

namespace sdm {
namespace {

struct HullFace {
  std::array<std::uint32_t, 3> corner{};
  std::array<std::uint32_t, 3> across{};   // the face beyond the side from corner i to corner i + 1
  std::vector<std::uint32_t> seen_from{};  // points outside that are on no other face's list
  bool gone = false;
};

// Whether the points are on one line: a plane through other points has at most three of these.
bool on_one_line(const Vec3& a, const Vec3& b, const Vec3& c) {
  const std::array<Vec3, 4> others{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  return std::ranges::all_of(others, [&](const Vec3& p) { return orientation(a, b, c, p) == 0; });
}

class Hull {
 public:
  explicit Hull(std::span<const Vec3> points) : points_(points), begins_at_(points.size()) {}

  // Requires at least one point.
  std::span<const HullFace> find() {
    begin();
    for (std::uint32_t face = 0; face < faces_.size(); ++face)
      while (!faces_[face].gone && !faces_[face].seen_from.empty()) extend_to(farthest(face), face);
    return faces_;
  }

 private:
  [[nodiscard]] bool sees(std::uint32_t point, const HullFace& face) const {
    const auto& [a, b, c] = face.corner;
    return orientation(points_[a], points_[b], points_[c], points_[point]) > 0;
  }

  // The point with the largest value, to rounding, or if that one will not do, any other that does.
  template <class Value, class Allowed>
  std::uint32_t choose(const Value& value, const Allowed& allowed) const {
    std::uint32_t best = 0;
    double most = -1;
    for (std::uint32_t p = 0; p < points_.size(); ++p)
      if (const double x = value(points_[p]); x > most) {
        most = x;
        best = p;
      }
    if (allowed(points_[best])) return best;
    for (std::uint32_t p = 0; p < points_.size(); ++p)
      if (allowed(points_[p])) return p;
    throw Error(
        "the corners of the faces are in one plane, so that their convex hull has no inside; use a mesh that "
        "is not flat");
  }

  // A tetrahedron.
  void begin() {
    const Vec3& a = points_[0];
    const std::uint32_t b =
        choose([&](const Vec3& p) { return squared_norm(p - a); }, [&](const Vec3& p) { return p != a; });
    const Vec3 side = points_[b] - a;
    const std::uint32_t c = choose([&](const Vec3& p) { return squared_norm(cross(side, p - a)); },
                                   [&](const Vec3& p) { return !on_one_line(a, points_[b], p); });
    const Vec3 normal = cross(side, points_[c] - a);
    const std::uint32_t d =
        choose([&](const Vec3& p) { return std::abs(dot(normal, p - a)); },
               [&](const Vec3& p) { return orientation(a, points_[b], points_[c], p) != 0; });
    std::array<std::uint32_t, 4> v{0, b, c, d};
    if (orientation(a, points_[b], points_[c], points_[d]) > 0) std::swap(v[1], v[2]);
    faces_ = {{{v[0], v[1], v[2]}, {1, 2, 3}},
              {{v[1], v[0], v[3]}, {0, 3, 2}},
              {{v[2], v[1], v[3]}, {0, 1, 3}},
              {{v[0], v[2], v[3]}, {0, 2, 1}}};
    for (std::uint32_t p = 0; p < points_.size(); ++p) assign(p, 0);
  }

  // Adds the point to the list of a face that it sees, from a face on.
  void assign(std::uint32_t point, std::size_t first) {
    for (std::size_t face = first; face < faces_.size(); ++face)
      if (sees(point, faces_[face])) return faces_[face].seen_from.push_back(point);
  }

  [[nodiscard]] std::uint32_t farthest(std::uint32_t face) const {
    const auto& [a, b, c] = faces_[face].corner;
    const Vec3 normal = cross(points_[b] - points_[a], points_[c] - points_[a]);
    return *std::ranges::max_element(faces_[face].seen_from, {},
                                     [&](std::uint32_t p) { return dot(normal, points_[p] - points_[a]); });
  }

  // Replaces the faces that the point sees by those from their outline to the point.
  void extend_to(std::uint32_t point, std::uint32_t face) {
    seen_.assign(1, face);
    outline_.clear();
    faces_[face].gone = true;
    for (std::size_t i = 0; i < seen_.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t next = faces_[seen_[i]].across[k];
        if (faces_[next].gone) continue;
        if (sees(point, faces_[next])) {
          faces_[next].gone = true;
          seen_.push_back(next);
        } else
          outline_.push_back({seen_[i], k});
      }
    const auto first = static_cast<std::uint32_t>(faces_.size());
    for (const auto& [seen, k] : outline_) add(point, seen, k);
    for (std::size_t f = first; f < faces_.size(); ++f) {
      const std::uint32_t after = begins_at_[faces_[f].corner[1]];
      faces_[f].across[1] = after;
      faces_[after].across[2] = static_cast<std::uint32_t>(f);
    }
    for (const std::uint32_t seen : seen_) {
      const std::vector<std::uint32_t> points = std::exchange(faces_[seen].seen_from, {});
      for (const std::uint32_t p : points)
        if (p != point) assign(p, first);
    }
  }
  // The face from a side of one that is seen, whose neighbour there is not.
  void add(std::uint32_t point, std::uint32_t seen, int k) {
    const auto face = static_cast<std::uint32_t>(faces_.size());
    const std::uint32_t from = faces_[seen].corner[k], to = faces_[seen].corner[(k + 1) % 3],
                        beyond = faces_[seen].across[k];
    for (int j = 0; j < 3; ++j)
      if (faces_[beyond].corner[j] == to && faces_[beyond].across[j] == seen) faces_[beyond].across[j] = face;
    begins_at_[from] = face;
    faces_.push_back({{from, to, point}, {beyond, 0, 0}});
  }

  std::span<const Vec3> points_;
  std::vector<HullFace> faces_;
  std::vector<std::uint32_t> seen_, begins_at_;         // the new face of the outline at a point
  std::vector<std::pair<std::uint32_t, int>> outline_;  // sides of faces that are seen
};

Mesh hull_of(const Mesh& mesh) {
  std::vector<std::uint8_t> used(mesh.positions.size());
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) used[vertex] = 1;
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] != 0) points.push_back(mesh.positions[v]);
  if (points.empty()) throw Error("a mesh without faces has no convex hull; use one with faces");
  Hull search(points);
  const std::span<const HullFace> faces = search.find();
  Mesh result;
  std::vector<std::uint32_t> number(points.size(), kNone);
  for (const HullFace& face : faces)
    if (!face.gone)
      for (const std::uint32_t corner : face.corner) number[corner] = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (number[p] == kNone) continue;
    number[p] = static_cast<std::uint32_t>(result.positions.size());
    result.positions.push_back(points[p]);
  }
  for (const HullFace& face : faces) {
    const auto& [a, b, c] = face.corner;
    if (!face.gone) result.triangles.push_back({number[a], number[b], number[c]});
  }
  return result;
}

}  // namespace

Mesh convex_hull(const Mesh& mesh) try {
  validate(mesh);
  return hull_of(mesh);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a convex hull");
}

}  // namespace sdm
