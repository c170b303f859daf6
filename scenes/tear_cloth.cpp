#include <algorithm>

#include "scenes/cloth.h"

namespace sdm::scenes {
namespace {

bool has(const Triangle& t, std::uint32_t vertex) {
  return t[0] == vertex || t[1] == vertex || t[2] == vertex;
}

}  // namespace

MeshEdit Cloth::tear(double limit) {
  struct Long {
    double ratio;
    std::uint32_t a, b;
  };
  std::vector<Long> long_edges;
  for (const Spring& s : springs_) {
    const double ratio = norm(positions_[s.b] - positions_[s.a]) / s.length;
    if (s.across[0] == kNone && ratio > limit) long_edges.push_back({ratio, s.a, s.b});
  }
  std::ranges::stable_sort(long_edges, std::greater(), &Long::ratio);
  // A tear relieves what is around it: particles are split once, and their neighbours in the next step.
  MeshEdit edit;
  std::vector<std::uint8_t> done(positions_.size(), 0);
  for (const auto& [ratio, a, b] : long_edges) {
    if (done[a] || done[b]) continue;
    const Vec3 direction = positions_[b] - positions_[a];
    if (!split(a, direction, edit) && !split(b, -direction, edit)) continue;
    for (const Spring& s : springs_)
      if (has({a, b, b}, s.a) || has({a, b, b}, s.b))
        for (const std::uint32_t v : {s.a, s.b})
          if (v < done.size()) done[v] = 1;
  }
  return edit;
}

// The faces whose middles lie behind the particle, seen along `direction`, get a copy of it. False if these
// are all of its faces or none.
bool Cloth::split(std::uint32_t particle, const Vec3& direction, MeshEdit& edit) {
  if (mobility_[particle] == 0) return false;
  std::vector<std::uint32_t> behind;
  std::size_t ahead = 0;
  for (std::uint32_t f = 0; f < mesh_.triangles.size(); ++f) {
    const Triangle& t = mesh_.triangles[f];
    if (!has(t, particle)) continue;
    const Vec3 middle = (1.0 / 3) * (positions_[t[0]] + positions_[t[1]] + positions_[t[2]]);
    if (dot(middle - positions_[particle], direction) < 0)
      behind.push_back(f);
    else
      ++ahead;
  }
  if (behind.empty() || ahead == 0) return false;
  const auto copy = static_cast<std::uint32_t>(positions_.size());
  for (const std::uint32_t f : behind) {
    std::ranges::replace(mesh_.triangles[f], particle, copy);
    const auto known = std::ranges::find(edit.reconnected_faces, f, &MeshEdit::ReconnectedFace::face);
    if (known != edit.reconnected_faces.end())
      known->triangle = mesh_.triangles[f];
    else
      edit.reconnected_faces.push_back({f, mesh_.triangles[f]});
  }
  edit.added_vertices.push_back(positions_[particle]);
  mesh_.positions.push_back(mesh_.positions[particle]);
  for (std::vector<Vec3>* values : {&positions_, &previous_, &velocities_})
    values->push_back((*values)[particle]);
  mobility_.push_back(1);
  reconnect_springs(particle, copy);
  return true;
}

// An edge that is now an edge of both gets a spring for each. Springs across the particle, or to it from
// beyond its faces, disappear.
void Cloth::reconnect_springs(std::uint32_t particle, std::uint32_t copy) {
  std::vector<Spring> springs;
  for (Spring s : springs_) {
    const bool at = s.a == particle || s.b == particle;
    const bool is_edge = s.across[0] == kNone;
    if (!is_edge && (at || s.across[0] == particle || s.across[1] == particle)) continue;
    if (!at) {
      springs.push_back(s);
      continue;
    }
    const std::uint32_t other = s.a == particle ? s.b : s.a;
    for (const std::uint32_t end : {particle, copy})
      if (std::ranges::any_of(mesh_.triangles,
                              [&](const Triangle& t) { return has(t, end) && has(t, other); })) {
        s.a = end;
        s.b = other;
        springs.push_back(s);
      }
  }
  springs_ = std::move(springs);
}

}  // namespace sdm::scenes
