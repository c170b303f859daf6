#include "io/mesh/polygons/polygon_mesh.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <bit>
#include <string>

#include "core/cancellation.h"
#include "core/platform.h"
#include "geometry/vec.h"
#include "io/mesh/polygons/triangulate.h"

namespace sdm::io {
namespace {

constexpr std::uint32_t kPolled = 4096;  // steps

std::ptrdiff_t face_of_corner(const PolygonMesh& polygons, std::size_t corner) {
  return std::ranges::upper_bound(polygons.ends, corner) - polygons.ends.begin();
}

void check_indices(const PolygonMesh& polygons) {
  if (polygons.ends.empty()) {
    if (polygons.positions.empty()) throw Error("there are no triangles");
    throw Error(
        fmt::format("there are no triangles, only a cloud of {} points; reconstruct a mesh from them first",
                    polygons.positions.size()));
  }
  Poll due(kPolled);
  for (std::size_t c = 0; c < polygons.corners.size(); ++c) {
    due();
    if (polygons.corners[c] < polygons.positions.size()) continue;
    throw Error(fmt::format("index out of range: face {} refers to vertex {} of {}",
                            face_of_corner(polygons, c), polygons.corners[c], polygons.positions.size()));
  }
}

std::uint64_t mix(std::uint64_t h) {
  h = (h ^ h >> 32) * 0xD6E8FEB86659FD93u;
  return h ^ h >> 32;
}

// Random, so that no file can be crafted to cause collisions in the hash table. Results do not depend on it.
std::uint64_t hash_seed() {
  static const std::uint64_t seed = random_number();
  return seed;
}

// An open hash table of positions, in one body or several.
class PositionTable {
 public:
  PositionTable(std::size_t capacity, const std::vector<Vec3>& positions)
      : positions_(positions), slots_(std::bit_ceil(capacity + capacity / 2 + 1), kNone) {}

  /// Returns the index of an equal position of the body inserted earlier. Otherwise inserts and returns
  /// `index`; the caller then appends p to `positions`.
  std::uint32_t find_or_insert(const Vec3& p, std::uint32_t body, std::uint32_t index) {
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t slot = hash(p, body) & mask;; slot = (slot + 1) & mask) {
      if (slots_[slot] == kNone) {
        if (body != 0) {
          bodies_.resize(index, 0);
          bodies_.push_back(body);
        }
        return slots_[slot] = index;
      }
      if (positions_[slots_[slot]] == p && body_of(slots_[slot]) == body) return slots_[slot];
    }
  }

 private:
  [[nodiscard]] std::uint32_t body_of(std::uint32_t index) const {
    return index < bodies_.size() ? bodies_[index] : 0;
  }
  [[nodiscard]] std::size_t hash(const Vec3& p, std::uint32_t body) const {
    std::uint64_t h = seed_ ^ body;
    for (const double x : p) h = mix(h ^ std::bit_cast<std::uint64_t>(x + 0.0));  // −0 + 0 = 0
    return h;
  }

  const std::vector<Vec3>& positions_;
  std::vector<std::uint32_t> slots_;
  std::vector<std::uint32_t> bodies_;  // of the first positions inserted; 0 of all others
  std::uint64_t seed_ = hash_seed();
};

// Fills mesh.positions. Returns the new index of each vertex of the file, kNone for those without a face.
std::vector<std::uint32_t> weld(const PolygonMesh& polygons, Mesh& mesh) {
  std::vector<std::uint32_t> renumbered(polygons.positions.size(), kNone);
  for (const std::uint32_t v : polygons.corners) renumbered[v] = 0;
  const auto used = polygons.positions.size() -
                    static_cast<std::size_t>(std::count(renumbered.begin(), renumbered.end(), kNone));
  mesh.positions.reserve(used);
  PositionTable table(used, mesh.positions);
  Poll due(kPolled);
  for (std::size_t v = 0; v < renumbered.size(); ++v) {
    due();
    if (renumbered[v] == kNone) continue;
    if (!finite(polygons.positions[v]))
      throw Error(fmt::format("vertex {} has a NaN or infinite coordinate", v));
    const auto next = static_cast<std::uint32_t>(mesh.positions.size());
    renumbered[v] =
        table.find_or_insert(polygons.positions[v], polygons.bodies.empty() ? 0 : polygons.bodies[v], next);
    if (renumbered[v] == next) mesh.positions.push_back(polygons.positions[v]);
  }
  return renumbered;
}

bool has_uv(const PolygonMesh& polygons, std::uint32_t index) {
  return index < polygons.uvs.size() && std::isfinite(polygons.uvs[index][0]) &&
         std::isfinite(polygons.uvs[index][1]);
}

bool all_corners_have_uvs(const PolygonMesh& polygons) {
  return !polygons.corner_uvs.empty() &&
         std::ranges::all_of(polygons.corner_uvs, [&](std::uint32_t i) { return has_uv(polygons, i); });
}

// Collects the corners of one polygon, as indices into PolygonMesh::corners. Of consecutive corners on the
// same vertex only the first is kept, as long as three corners remain: many exporters write triangles as
// quads with a repeated corner.
void gather(const std::vector<std::uint32_t>& corners, const std::vector<std::uint32_t>& renumbered,
            std::uint32_t begin, std::uint32_t end, std::vector<std::uint32_t>& places) {
  places.clear();
  const auto same = [&](std::uint32_t a, std::uint32_t b) {
    return renumbered[corners[a]] == renumbered[corners[b]];
  };
  for (std::uint32_t c = begin; c < end; ++c)
    if (places.empty() || !same(c, places.back()) || places.size() + (end - c) <= 3) places.push_back(c);
  while (places.size() > 3 && same(places.front(), places.back())) places.pop_back();
}

}  // namespace

void PolygonNames::begin(std::size_t polygon, std::string_view name) {
  std::uint32_t index = kNone;
  if (!name.empty()) {
    const auto found = index_.find(name);
    index = found != index_.end() ? found->second : static_cast<std::uint32_t>(names_.size());
    if (index == names_.size()) {
      names_.emplace_back(name);
      index_.emplace(name, index);
    }
  }
  runs_.push_back({static_cast<std::uint32_t>(polygon), index});
}

void PolygonMesh::end_polygon() {
  thread_local Poll due(kPolled);
  due();
  const std::size_t begin = ends.empty() ? 0 : ends.back();
  if (corners.size() >= kNone) throw Error("there are more than 2^32 corners of faces");
  if (corners.size() - begin >= 3) {
    ends.push_back(static_cast<std::uint32_t>(corners.size()));
  } else {
    corners.resize(begin);
    if (corner_uvs.size() > begin) corner_uvs.resize(begin);
  }
}

std::string uv_fault(const PolygonMesh& polygons) {
  const auto& indices = polygons.corner_uvs;
  const auto fault = std::ranges::find_if_not(indices, [&](std::uint32_t i) { return has_uv(polygons, i); });
  if (fault == indices.end() || std::ranges::count(indices, kNone) == std::ssize(indices)) return {};
  const std::string face =
      fmt::format("the texture coordinates are left out: face {}",
                  face_of_corner(polygons, static_cast<std::size_t>(fault - indices.begin())));
  return face +
         (*fault < polygons.uvs.size() ? " has some that are infinite or NaN" : " has none at a corner");
}

Mesh to_mesh(const PolygonMesh& polygons) {
  std::vector<std::uint32_t> renumbered;
  return to_mesh(polygons, renumbered);
}

Mesh to_mesh(const PolygonMesh& polygons, std::vector<std::uint32_t>& renumbered) {
  std::vector<std::uint32_t> triangle_ends;
  return to_mesh(polygons, renumbered, triangle_ends);
}

Mesh to_mesh(const PolygonMesh& polygons, std::vector<std::uint32_t>& renumbered,
             std::vector<std::uint32_t>& triangle_ends, std::vector<Triangle>* places) {
  check_indices(polygons);
  Mesh mesh;
  renumbered = weld(polygons, mesh);
  const bool with_uvs = all_corners_have_uvs(polygons);
  const std::size_t triangle_count = polygons.corners.size() - 2 * polygons.ends.size();
  mesh.triangles.reserve(triangle_count);
  if (places) {
    places->clear();
    places->reserve(triangle_count);
  }
  if (with_uvs) mesh.corner_uvs.reserve(triangle_count);

  triangle_ends.clear();
  triangle_ends.reserve(polygons.ends.size());
  Triangulator triangulator;
  std::vector<std::uint32_t> gathered;
  std::vector<Vec3> points;
  const auto add_triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const auto vertex = [&](std::uint32_t place) { return renumbered[polygons.corners[place]]; };
    mesh.triangles.push_back({vertex(a), vertex(b), vertex(c)});
    if (places) places->push_back({a, b, c});
    const auto uv = [&](std::uint32_t place) { return polygons.uvs[polygons.corner_uvs[place]]; };
    if (with_uvs) mesh.corner_uvs.push_back({uv(a), uv(b), uv(c)});
  };
  std::uint32_t begin = 0;
  Poll due(kPolled);
  for (const std::uint32_t end : polygons.ends) {
    due();
    if (end - begin == 3) {
      add_triangle(begin, begin + 1, begin + 2);
    } else {
      gather(polygons.corners, renumbered, begin, end, gathered);
      points.clear();
      for (const std::uint32_t place : gathered)
        points.push_back(mesh.positions[renumbered[polygons.corners[place]]]);
      for (const auto& t : triangulator.triangulate(points))
        add_triangle(gathered[t[0]], gathered[t[1]], gathered[t[2]]);
    }
    triangle_ends.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
    begin = end;
  }
  return mesh;
}

}  // namespace sdm::io
