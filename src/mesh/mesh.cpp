#include <sdm/error.h>
#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <mutex>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "geometry/vec.h"
#include "mesh/validate.h"

namespace sdm {
namespace {

constexpr std::size_t kMaxTriangles = std::size_t{1} << 30;

// Distances are stored in single precision, and products of six coordinates must be finite in double: both
// are true up to this coordinate.
using mesh::kMaxCoordinate, mesh::kMinSize;

bool has_area(const Mesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.positions[t[0]];
  const Vec3 n = cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
  return n != Vec3{};
}

[[noreturn]] void throw_no_area() {
  throw Error("all triangles are degenerate: none has positive area");
}

void validate_counts(const Mesh& mesh) {
  if (mesh.triangles.size() > kMaxTriangles)
    throw Error("there are " + std::to_string(mesh.triangles.size()) + " triangles, more than 2^30");
  if (mesh.positions.size() >= kNone)
    throw Error("there are " + std::to_string(mesh.positions.size()) +
                " vertices, too many for 32-bit indices");
}

void validate_size(const Box& box) {
  if (!(diagonal(box) > kMinSize))
    throw Error("the mesh is smaller than 1e-30, too small for the computation; scale it up");
}

// The bounds of the mesh. Each vertex is compared at the first of its corners, which takes a quarter of what
// it takes at all of them.
Box validate_triangles(const Mesh& mesh) {
  const std::span<const Vec3> positions(mesh.positions);
  const std::span<const Triangle> triangles(mesh.triangles);
  Box box;
  bool any_area = false;
  std::vector<std::uint8_t> met(positions.size());
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const Triangle t = triangles[f];
    for (const std::uint32_t v : t)
      if (v >= positions.size())
        throw Error("index out of range: triangle " + std::to_string(f) + " refers to vertex " +
                    std::to_string(v) + " of " + std::to_string(positions.size()));
    any_area = any_area || has_area(mesh, t);
    if (is_removed(t)) continue;
    for (const std::uint32_t v : t) {
      if (met[v] != 0) continue;
      met[v] = 1;
      extend(box, positions[v]);
    }
  }
  if (!any_area) throw_no_area();
  return box;
}

void validate_uvs(const Mesh& mesh) {
  if (!mesh.corner_uvs.empty() && mesh.corner_uvs.size() != mesh.triangles.size())
    throw Error("there are texture coordinates for " + std::to_string(mesh.corner_uvs.size()) + " of " +
                std::to_string(mesh.triangles.size()) + " triangles; give them for all or for none");
  for (std::size_t f = 0; f < mesh.corner_uvs.size(); ++f)
    for (const Vec2& uv : mesh.corner_uvs[f])
      if (!std::isfinite(uv[0]) || !std::isfinite(uv[1]))
        throw Error("triangle " + std::to_string(f) + " has a NaN or infinite texture coordinate");
}

}  // namespace

void mesh::validate_positions(std::span<const Vec3> positions) {
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!finite(positions[v]))
      throw Error("vertex " + std::to_string(v) + " has a NaN or infinite coordinate");
    for (const double x : positions[v])
      if (std::abs(x) > kMaxCoordinate)
        throw Error("vertex " + std::to_string(v) +
                    " has a coordinate beyond 1e37, too large for the computation; scale the mesh down");
  }
}

void mesh::validate_positions(std::span<const Vec3> positions, std::size_t count) {
  if (positions.size() != count)
    throw Error("the mesh has " + std::to_string(count) + " vertices, but " +
                std::to_string(positions.size()) + " new positions were given");
  mesh::validate_positions(positions);
}

void mesh::validate_queries(std::span<const Vec3> points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const double x : points[i])
      if (!(std::abs(x) <= kMaxCoordinate))
        throw Error("query point " + std::to_string(i) + " has a coordinate that is NaN or beyond 1e37");
}

void mesh::validate_edited(const Mesh& mesh) {
  validate_counts(mesh);
  if (std::ranges::none_of(mesh.triangles, [&](const Triangle& t) { return has_area(mesh, t); }))
    throw_no_area();
  validate_size(bounds(mesh));
  validate_uvs(mesh);
}

Box mesh::validated_bounds(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw Error("there are no triangles");
  validate_counts(mesh);
  mesh::validate_positions(mesh.positions);
  const Box box = validate_triangles(mesh);
  validate_size(box);
  validate_uvs(mesh);
  return box;
}

void validate(const Mesh& mesh) {
  (void)mesh::validated_bounds(mesh);
}

Box bounds(const Mesh& mesh) {
  Box box;
  std::mutex mutex;
  parallel_for(mesh.triangles.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    Box part;
    for (std::size_t f = begin; f < end; ++f)
      if (!is_removed(mesh.triangles[f]))
        for (const std::uint32_t v : mesh.triangles[f]) extend(part, mesh.positions[v]);
    if (!(part.lower[0] <= part.upper[0]))
      return;  // only removed faces: an empty box would extend to infinity
    const std::lock_guard lock(mutex);
    extend(box, part);
  });
  return box;
}

}  // namespace sdm
