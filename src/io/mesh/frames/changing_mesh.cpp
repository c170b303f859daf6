#include "io/mesh/frames/changing_mesh.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <compare>
#include <utility>

#include "geometry/vec.h"
#include "mesh/validate.h"

namespace sdm::io {
namespace {

// The corner from which the cycle is smallest in lexicographic order. Cost: linear, since each comparison
// that ends rules out the starts of all that it has compared.
std::uint32_t smallest_rotation(std::span<const std::uint32_t> cycle) {
  const std::size_t n = cycle.size();
  std::size_t a = 0, b = 1;  // the candidates
  for (std::size_t length = 0; a < n && b < n && length < n;) {
    const std::uint32_t x = cycle[(a + length) % n], y = cycle[(b + length) % n];
    if (x == y) {
      ++length;
      continue;
    }
    (x > y ? a : b) += length + 1;
    if (a == b) ++b;
    length = 0;
  }
  return static_cast<std::uint32_t>(std::min(a, b));
}

// A polygon, with its cycle from the smallest rotation on.
struct Entry {
  std::span<const std::uint32_t> cycle;
  std::uint32_t polygon, start;

  [[nodiscard]] std::uint32_t at(std::size_t i) const {
    const std::size_t place = start + i;
    return cycle[place < cycle.size() ? place : place - cycle.size()];
  }
  [[nodiscard]] std::strong_ordering compare_cycles(const Entry& other) const {
    if (const auto order = cycle.size() <=> other.cycle.size(); order != 0) return order;
    for (std::size_t i = 0; i < cycle.size(); ++i)
      if (const auto order = at(i) <=> other.at(i); order != 0) return order;
    return std::strong_ordering::equal;
  }
  [[nodiscard]] bool operator<(const Entry& other) const {
    const auto order = compare_cycles(other);
    return order != 0 ? order < 0 : polygon < other.polygon;
  }
};

bool has_number(std::span<const std::uint32_t> cycle) {
  return std::ranges::find(cycle, kNone) == cycle.end();
}

// The polygons that are still free and whose vertices all have numbers, sorted.
template <class Free>
std::vector<Entry> sorted(const PolygonCycles& polygons, const Free& is_free) {
  std::vector<Entry> entries;
  for (std::uint32_t p = 0; p < polygons.size(); ++p)
    if (is_free(p) && has_number(polygons[p]))
      entries.push_back({polygons[p], p, smallest_rotation(polygons[p])});
  std::ranges::sort(entries, [](const Entry& a, const Entry& b) { return a < b; });
  return entries;
}

constexpr double kWeldTolerance = 1e-6;  // of the diagonal of the mesh

std::size_t count_present(std::span<const Triangle> triangles) {
  return triangles.size() - static_cast<std::size_t>(std::ranges::count_if(triangles, is_removed));
}

// Whether no vertex is used twice, as in STL files: the numbers then follow from the places of the faces, and
// those after a face that was removed are others.
bool is_soup(const PolygonCycles& polygons, std::size_t vertices) {
  std::vector<std::uint8_t> used(vertices, 0);
  return std::ranges::none_of(polygons.corners,
                              [&](std::uint32_t v) { return std::exchange(used[v], 1) != 0; });
}

// Returns for each vertex of the file the first one that is the same vertex of the mesh, or kNone.
std::vector<std::uint32_t> first_of_each(std::span<const std::uint32_t> vertex, std::size_t mesh_vertices) {
  std::vector<std::uint32_t> first(mesh_vertices, kNone), result(vertex.size(), kNone);
  for (std::uint32_t v = 0; v < vertex.size(); ++v) {
    if (vertex[v] == kNone) continue;
    if (first[vertex[v]] == kNone) first[vertex[v]] = v;
    result[v] = first[vertex[v]];
  }
  return result;
}

PolygonCycles renumbered(PolygonCycles polygons, std::span<const std::uint32_t> numbers) {
  for (std::uint32_t& v : polygons.corners) v = numbers[v];
  return polygons;
}

}  // namespace

void match_polygons(const PolygonCycles& before, const PolygonCycles& now,
                    std::vector<PolygonMatch>& matches) {
  std::vector<std::uint8_t> taken(before.size(), 0);
  for (const PolygonMatch& match : matches)
    if (match.polygon != kNone) taken[match.polygon] = 1;
  for (std::uint32_t p = 0; p < std::min(before.size(), now.size()); ++p)
    if (matches[p].polygon == kNone && !taken[p] && has_number(now[p]) &&
        std::ranges::equal(before[p], now[p])) {
      matches[p] = {p, 0};
      taken[p] = 1;
    }
  const std::vector<Entry> earlier = sorted(before, [&](std::uint32_t p) { return !taken[p]; });
  const std::vector<Entry> later = sorted(now, [&](std::uint32_t p) { return matches[p].polygon == kNone; });
  for (auto e = earlier.begin(), l = later.begin(); e != earlier.end() && l != later.end();) {
    const auto order = e->compare_cycles(*l);
    if (order == 0) {
      const auto n = static_cast<std::uint32_t>(l->cycle.size());
      matches[l->polygon] = {e->polygon, (l->start + n - e->start) % n};
    }
    e += order <= 0;
    l += order >= 0;
  }
}

std::span<const ChangingMesh::Face> ChangingMesh::Faces::of(std::uint32_t polygon) const {
  const std::size_t begin = polygon == 0 ? 0 : ends[polygon - 1];
  return std::span(faces).subspan(begin, ends[polygon] - begin);
}

// A file's mesh by itself, and what it has in common with the mesh before.
struct ChangingMesh::NextFile {
  Mesh mesh;
  std::vector<std::uint32_t> vertex;  // of `mesh`, of each vertex of the file, or kNone
  PolygonCycles cycles;
  Faces faces;                        // with their numbers in `mesh`
  std::vector<std::uint32_t> number;  // in the mesh before, of each vertex of `mesh`, or kNone
  std::vector<PolygonMatch> matches;  // with the polygons of the file before

  explicit NextFile(PolygonMesh polygons) {
    std::vector<Triangle> places;
    mesh = to_mesh(polygons, vertex, faces.ends, &places);
    validate(mesh);
    cycles = {std::move(polygons.corners), std::move(polygons.ends)};
    std::uint32_t t = 0;
    for (std::size_t p = 0; p < cycles.size(); ++p) {
      const std::uint32_t begin = p == 0 ? 0 : cycles.ends[p - 1];
      for (; t < faces.ends[p]; ++t) {
        const auto& [a, b, c] = places[t];
        faces.faces.push_back({is_removed(mesh.triangles[t]) ? kNone : t, {a - begin, b - begin, c - begin}});
      }
    }
    number.assign(mesh.positions.size(), kNone);
    matches.resize(cycles.size());
  }

  // Vertices keep their numbers if they have the same number in the files.
  void keep_numbered(std::span<const std::uint32_t> before, std::size_t mesh_vertices) {
    std::vector<std::uint8_t> taken(mesh_vertices, 0);
    for (std::size_t v = 0; v < std::min(before.size(), vertex.size()); ++v)
      if (vertex[v] != kNone && before[v] != kNone && number[vertex[v]] == kNone && !taken[before[v]]) {
        number[vertex[v]] = before[v];
        taken[before[v]] = 1;
      }
  }

  // Vertices keep their numbers if they have not moved.
  void keep_unmoved(std::span<const std::uint32_t> before, std::span<const Vec3> positions) {
    const auto position = [&](std::uint32_t v) { return positions[v]; };
    std::vector<std::uint32_t> used(before.begin(), before.end());
    std::erase(used, kNone);
    std::ranges::stable_sort(used, {}, position);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const auto at = std::ranges::lower_bound(used, mesh.positions[v], {}, position);
      if (at != used.end() && positions[*at] == mesh.positions[v]) number[v] = *at;
    }
  }
};

// The edit from the mesh before to that of the next file, whose vertices and faces get their numbers.
class ChangingMesh::EditToNext {
 public:
  EditToNext(const ChangingMesh& before, NextFile& next) : before_(before), next_(next) {
    kept_.assign(before.mesh_.triangles.size(), 0);
    number_vertices();
    std::uint32_t begin = 0;
    for (std::uint32_t p = 0; p < next.cycles.size(); ++p) {
      number_faces(p, begin);
      faces.ends.push_back(static_cast<std::uint32_t>(faces.faces.size()));
      begin = next.cycles.ends[p];
    }
    for (std::uint32_t f = 0; f < kept_.size(); ++f)
      if (!kept_[f] && !is_removed(before.mesh_.triangles[f])) edit.removed_faces.push_back(f);
  }

  // Whether at least half of the faces stay, before and after.
  [[nodiscard]] bool keeps_half() const {
    const std::size_t before = count_present(before_.mesh_.triangles),
                      stay = before - edit.removed_faces.size();
    return 2 * stay >= std::max(before, count_present(next_.mesh.triangles));
  }

  MeshEdit edit;
  Faces faces;

 private:
  void number_vertices() {
    for (std::size_t v = 0; v < next_.number.size(); ++v) {
      std::uint32_t& number = next_.number[v];
      const Vec3& p = next_.mesh.positions[v];
      if (number == kNone) {
        number = static_cast<std::uint32_t>(before_.mesh_.positions.size() + edit.added_vertices.size());
        edit.added_vertices.push_back(p);
      } else if (p != before_.mesh_.positions[number]) {
        edit.moved_vertices.push_back({number, p});
      }
    }
  }

  // `begin`: of the corners of the polygon.
  void number_faces(std::uint32_t polygon, std::uint32_t begin) {
    const auto [earlier, shift] = next_.matches[polygon];
    const std::span<const Face> fresh = next_.faces.of(polygon);
    // A polygon that stays is not triangulated again, unless corners have met or parted.
    if (earlier == kNone || before_.faces_.of(earlier).size() != fresh.size()) {
      for (const Face& face : fresh) add(face.places, begin);
      return;
    }
    const std::uint32_t size = next_.cycles.ends[polygon] - begin;
    for (const auto& [number, earlier_places] : before_.faces_.of(earlier)) {
      Triangle places;
      for (int k = 0; k < 3; ++k) places[k] = (earlier_places[k] + shift) % size;
      if (number == kNone)
        add(places, begin);
      else
        keep(number, places, begin);
    }
  }

  void keep(std::uint32_t number, const Triangle& places, std::uint32_t begin) {
    const Triangle triangle = numbered(places, begin);
    if (is_removed(triangle)) return add(places, begin);
    kept_[number] = 1;
    faces.faces.push_back({number, places});
    if (triangle != before_.mesh_.triangles[number]) edit.reconnected_faces.push_back({number, triangle});
  }

  void add(const Triangle& places, std::uint32_t begin) {
    const Triangle triangle = numbered(places, begin);
    if (is_removed(triangle)) {
      faces.faces.push_back({kNone, places});
      return;
    }
    faces.faces.push_back(
        {static_cast<std::uint32_t>(before_.mesh_.triangles.size() + edit.added_faces.size()), places});
    edit.added_faces.push_back(triangle);
  }

  [[nodiscard]] Triangle numbered(const Triangle& places, std::uint32_t begin) const {
    Triangle triangle;
    for (int k = 0; k < 3; ++k)
      triangle[k] = next_.number[next_.vertex[next_.cycles.corners[begin + places[k]]]];
    return triangle;
  }

  const ChangingMesh& before_;
  NextFile& next_;
  std::vector<std::uint8_t> kept_;
};

ChangingMesh::ChangingMesh(PolygonMesh polygons) {
  start(NextFile(std::move(polygons)));
  change_ = {};
}

void ChangingMesh::start(NextFile next) {
  weld_tolerance_ = kWeldTolerance * diagonal(bounds(next.mesh));
  mesh_ = std::move(next.mesh);  // from here on, nothing fails
  vertex_ = std::move(next.vertex);
  cycles_ = std::move(next.cycles);
  faces_ = std::move(next.faces);
  change_ = {.edit = {}, .replaced = true};
}

void ChangingMesh::follow(PolygonMesh polygons) {
  const bool same = polygons.positions.size() == vertex_.size() && polygons.ends == cycles_.ends &&
                    polygons.corners == cycles_.corners;
  if (same && move(polygons)) return;
  // Which vertices are gone is unknown of a list that has become shorter.
  const bool numbers_stay =
      same || (polygons.positions.size() >= vertex_.size() && !is_soup(cycles_, vertex_.size()));
  if (numbers_stay) keep_welded(polygons);
  NextFile next(std::move(polygons));
  match(next, numbers_stay);
  EditToNext to_next(*this, next);
  if (!to_next.keeps_half()) return start(std::move(next));
  for (std::uint32_t& v : next.vertex)
    if (v != kNone) v = next.number[v];
  apply(mesh_, to_next.edit);
  vertex_ = std::move(next.vertex);
  cycles_ = std::move(next.cycles);
  faces_ = std::move(to_next.faces);
  change_ = {.edit = std::move(to_next.edit)};
}

// Moves the vertices of a mesh whose faces stay. False, without a change, if vertices that were one part.
bool ChangingMesh::move(const PolygonMesh& polygons) {
  std::vector<Vec3> positions = mesh_.positions;
  const std::vector<std::uint32_t> first = first_of_each(vertex_, positions.size());
  for (std::uint32_t v = 0; v < vertex_.size(); ++v) {
    if (first[v] == kNone) continue;
    const Vec3& p = polygons.positions[v];
    if (!finite(p)) throw Error(fmt::format("vertex {} has a NaN or infinite coordinate", v));
    if (first[v] == v)
      positions[vertex_[v]] = p;
    else if (norm(p - polygons.positions[first[v]]) > weld_tolerance_)
      return false;
  }
  mesh::validate_positions(positions);
  mesh_.positions = std::move(positions);
  change_ = {};
  return true;
}

// Vertices that were one and are still near each other stay one.
void ChangingMesh::keep_welded(PolygonMesh& polygons) const {
  const std::vector<std::uint32_t> first = first_of_each(vertex_, mesh_.positions.size());
  for (std::uint32_t v = 0; v < vertex_.size(); ++v)
    if (first[v] != kNone && norm(polygons.positions[v] - polygons.positions[first[v]]) <= weld_tolerance_)
      polygons.positions[v] = polygons.positions[first[v]];
}

// Matches faces by the numbers in the files, then by the vertices that those are now: a corner may refer to a
// copy.
void ChangingMesh::match(NextFile& next, bool numbers_stay) const {
  if (numbers_stay) {
    next.keep_numbered(vertex_, mesh_.positions.size());
    match_polygons(cycles_, next.cycles, next.matches);
    match_polygons(renumbered(cycles_, next.vertex), renumbered(next.cycles, next.vertex), next.matches);
  } else {
    next.keep_unmoved(vertex_, mesh_.positions);
    PolygonCycles now = renumbered(next.cycles, next.vertex);
    for (std::uint32_t& v : now.corners) v = next.number[v];
    match_polygons(renumbered(cycles_, vertex_), now, next.matches);
  }
}

}  // namespace sdm::io
