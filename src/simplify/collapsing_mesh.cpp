#include "simplify/collapsing_mesh.h"

#include <algorithm>
#include <array>

namespace sdm::simplify {
namespace {

bool has(const Triangle& t, std::uint32_t v) {
  return t[0] == v || t[1] == v || t[2] == v;
}

/// Whether a face that becomes another one turns its back, or loses its area.
bool turns(const Corners& before, const Corners& after) {
  constexpr double kLeastCosine = 0.1, kLeastArea = 1e-12;  // relative to the square of the longest side
  const Vec3 was = cross(before[1] - before[0], before[2] - before[0]);
  const Vec3 is = cross(after[1] - after[0], after[2] - after[0]);
  const double side = std::max({squared_norm(after[1] - after[0]), squared_norm(after[2] - after[1]),
                                squared_norm(after[0] - after[2])});
  const double area = squared_norm(is), area_before = squared_norm(was);
  if (!(area > kLeastArea * side * side)) return true;
  const double cosine = dot(was, is);
  return area_before > 0 &&
         (cosine < 0 || cosine * cosine < kLeastCosine * kLeastCosine * area * area_before);
}

}  // namespace

CollapsingMesh::CollapsingMesh(const Mesh& mesh)
    : positions_(mesh.positions),
      triangles_(mesh.triangles),
      faces_of_(positions_.size()),
      fixed_(positions_.size()),
      left_(triangles_.size()),
      shared_(positions_.size()) {
  std::vector<std::uint32_t> degree(positions_.size());
  for (const Triangle& t : triangles_)
    for (const std::uint32_t v : t) ++degree[v];
  for (std::size_t v = 0; v < degree.size(); ++v) faces_of_[v].reserve(degree[v]);
  for (std::uint32_t f = 0; f < triangles_.size(); ++f)
    for (const std::uint32_t v : triangles_[f]) faces_of_[v].push_back(f);
  for (std::uint32_t v = 0; v < fixed_.size(); ++v) fixed_[v] = !is_fan(v);
}

std::size_t CollapsingMesh::fixed_vertices() const {
  return static_cast<std::size_t>(std::ranges::count(fixed_, true));
}

void CollapsingMesh::count_neighbours(std::uint32_t v) {
  for (const std::uint32_t w : neighbours_) shared_[w] = 0;
  neighbours_.clear();
  for (const std::uint32_t f : faces_of_[v])
    for (const std::uint32_t w : triangles_[f]) {
      if (w == v) continue;
      if (shared_[w] == 0) neighbours_.push_back(w);
      if (shared_[w] < 3) ++shared_[w];
    }
}

std::span<const std::uint32_t> CollapsingMesh::neighbours(std::uint32_t v) {
  count_neighbours(v);
  return neighbours_;
}

// The faces around v are one closed or open fan.
bool CollapsingMesh::is_fan(std::uint32_t v) {
  count_neighbours(v);
  std::size_t ends = 0;
  for (const std::uint32_t w : neighbours_) {
    if (shared_[w] > 2) return false;
    ends += shared_[w] == 1 ? 1 : 0;
  }
  if (ends != 0 && ends != 2) return false;
  // Walk from face to face; as no edge has more than two, a walk that meets all of them is the fan.
  const std::vector<std::uint32_t>& faces = faces_of_[v];
  if (faces.empty()) return true;
  std::vector<std::uint32_t> open(faces.begin() + 1, faces.end());
  std::vector<std::uint32_t> next{faces[0]};
  while (!next.empty()) {
    const Triangle& t = triangles_[next.back()];
    next.pop_back();
    std::erase_if(open, [&](std::uint32_t f) {
      const bool beside =
          std::ranges::any_of(triangles_[f], [&](std::uint32_t w) { return w != v && has(t, w); });
      if (beside) next.push_back(f);
      return beside;
    });
  }
  return open.empty();
}

bool CollapsingMesh::keeps_topology(std::uint32_t u, std::uint32_t v) {
  if (fixed_[u] || fixed_[v]) return false;
  const auto is_border = [&] {
    return std::ranges::any_of(neighbours_, [&](std::uint32_t w) { return shared_[w] == 1; });
  };
  count_neighbours(u);
  const int faces = shared_[v];
  if (faces != 1 && faces != 2) return false;
  const bool border_u = is_border();
  const std::vector<std::uint32_t> around_u = neighbours_;
  count_neighbours(v);
  if (border_u && faces == 2 && is_border()) return false;
  const auto common =
      std::ranges::count_if(around_u, [&](std::uint32_t w) { return w != v && shared_[w] > 0; });
  if (common != faces) return false;
  // No two faces may become one, and the last face of a part stays.
  std::array<std::uint32_t, 2> opposite{kNone, kNone};
  int found = 0;
  for (const std::uint32_t f : faces_of_[u])
    if (has(triangles_[f], v))
      for (const std::uint32_t w : triangles_[f])
        if (w != u && w != v) opposite[found++] = w;
  if (faces == 1) return faces_of_[u].size() + faces_of_[v].size() > 2;
  const auto closes = [&](std::uint32_t f) {
    return has(triangles_[f], opposite[0]) && has(triangles_[f], opposite[1]);
  };
  return opposite[0] != opposite[1] &&
         !(std::ranges::any_of(faces_of_[u], closes) && std::ranges::any_of(faces_of_[v], closes));
}

bool CollapsingMesh::move(std::uint32_t u, std::uint32_t v, const Vec3& to,
                          std::vector<MovedFace>& moved) const {
  moved.clear();
  for (const std::uint32_t from : {u, v})
    for (const std::uint32_t f : faces_of_[from]) {
      const Triangle& t = triangles_[f];
      if (has(t, u) && has(t, v)) continue;
      const Corners before = corners(f);
      MovedFace face{f, t, before};
      for (int k = 0; k < 3; ++k)
        if (t[k] == from) {
          face.triangle[k] = u;
          face.corners[k] = to;
        }
      if (turns(before, face.corners)) return false;
      moved.push_back(face);
    }
  return !moved.empty();
}

void CollapsingMesh::collapse(std::uint32_t u, std::uint32_t v, const Vec3& to) {
  const auto remove_from = [&](std::uint32_t w, std::uint32_t f) { std::erase(faces_of_[w], f); };
  const std::vector<std::uint32_t> faces = std::move(faces_of_[v]);
  faces_of_[v] = {};
  for (const std::uint32_t f : faces) {
    Triangle& t = triangles_[f];
    if (has(t, u)) {
      for (const std::uint32_t w : t)
        if (w != v) remove_from(w, f);
      t = {kNone, kNone, kNone};
      --left_;
    } else {
      for (std::uint32_t& w : t)
        if (w == v) w = u;
      faces_of_[u].push_back(f);
    }
  }
  positions_[u] = to;
}

Mesh CollapsingMesh::mesh() const {
  std::vector<std::uint32_t> number(positions_.size(), kNone);
  for (const Triangle& t : triangles_)
    if (t[0] != kNone)
      for (const std::uint32_t v : t) number[v] = 0;
  Mesh mesh;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNone) continue;
    number[v] = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(positions_[v]);
  }
  mesh.triangles.reserve(left_);
  for (const Triangle& t : triangles_)
    if (t[0] != kNone) mesh.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  return mesh;
}

}  // namespace sdm::simplify
