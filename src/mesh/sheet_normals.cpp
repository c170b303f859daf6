#include "mesh/sheet_normals.h"

#include <sdm/error.h>
#include <sdm/mesh_attributes.h>
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <numbers>
#include <utility>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"

namespace sdm {
namespace mesh {
namespace {

// The most sheets searched for each corner: the tip of a cone of a million faces must not take 10^12 steps.
constexpr int kMostSheets = 64;

struct SheetFace {
  Vec3f normal{};                 ///< zero without area
  std::array<float, 3> angles{};  ///< at the corners
};

SheetFace shape_of(const Mesh& mesh, const Triangle& triangle) {
  SheetFace shape;
  std::array<Vec3, 3> edges;  // edges[k] from corner k to the next one
  for (int k = 0; k < 3; ++k) edges[k] = mesh.positions[triangle[(k + 1) % 3]] - mesh.positions[triangle[k]];
  const Vec3 normal = normalized(cross(edges[0], edges[1]));
  if (normal == Vec3{} || !finite(normal)) return shape;
  for (int k = 0; k < 3; ++k) {
    const Vec3 &a = edges[k], b = -edges[(k + 2) % 3];
    shape.normal[k] = static_cast<float>(normal[k]);
    // Relative to their size, as squares of lengths may underflow in single precision.
    const double sine = norm(cross(a, b)), cosine = dot(a, b), scale = 1 / std::max(sine, std::abs(cosine));
    shape.angles[k] = std::atan2(static_cast<float>(scale * sine), static_cast<float>(scale * cosine));
  }
  return shape;
}

double cosine(const Vec3f& a, const Vec3f& b) {
  return double{a[0]} * b[0] + double{a[1]} * b[1] + double{a[2]} * b[2];
}

}  // namespace

SheetNormals sheet_normals(const Mesh& mesh, double crease) {
  std::vector<SheetFace> shapes(mesh.triangles.size());
  constexpr std::size_t kGrain = 1024;
  parallel_for(mesh.triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face)
      if (!is_removed(mesh.triangles[face])) shapes[face] = shape_of(mesh, mesh.triangles[face]);
  });

  SheetNormals result;
  result.corner.resize(mesh.triangles.size(), {kNone, kNone, kNone});
  std::vector<Vec3f> first_face;  // of each sheet; zero while it has only faces without area
  std::vector<Vec3> sums;
  // The sheets of each vertex are a linked list: first[vertex], next[sheet], ...
  std::vector<std::uint32_t> first(mesh.positions.size(), kNone), next;
  for (std::size_t face = 0; face < mesh.triangles.size(); ++face) {
    if (is_removed(mesh.triangles[face])) continue;
    const Vec3f& normal = shapes[face].normal;
    const auto fits = [&](std::uint32_t sheet) {
      return normal == Vec3f{} || first_face[sheet] == Vec3f{} || cosine(first_face[sheet], normal) >= crease;
    };
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.triangles[face][k];
      std::uint32_t sheet = first[vertex];
      for (int looked_at = 1; sheet != kNone && !fits(sheet) && looked_at < kMostSheets; ++looked_at)
        sheet = next[sheet];
      if (sheet == kNone) {
        sheet = static_cast<std::uint32_t>(result.vertex.size());
        result.vertex.push_back(vertex);
        first_face.push_back(normal);
        sums.emplace_back();
        next.push_back(std::exchange(first[vertex], sheet));
      }
      if (first_face[sheet] == Vec3f{}) first_face[sheet] = normal;
      for (int c = 0; c < 3; ++c) sums[sheet][c] += double{shapes[face].angles[k]} * normal[c];
      result.corner[face][k] = sheet;
    }
  }
  result.normals.resize(sums.size());
  parallel_for(sums.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t sheet = begin; sheet < end; ++sheet) {
      const Vec3 n = normalized(sums[sheet]);
      if (n == Vec3{})
        result.normals[sheet] = {0, 0, 1};
      else
        for (int c = 0; c < 3; ++c) result.normals[sheet][c] = static_cast<float>(n[c]);
    }
  });
  return result;
}

SheetNormals sheet_normals(const Mesh& mesh, const MeshAttribute& normals) {
  SheetNormals result;
  result.corner.resize(mesh.triangles.size(), {kNone, kNone, kNone});
  // The sheets of each row of the attribute are a linked list: first[row], next[sheet], ...
  std::vector<std::uint32_t> first(normals.values.size() / 3, kNone), next;
  for (std::size_t face = 0; face < mesh.triangles.size(); ++face) {
    if (is_removed(mesh.triangles[face])) continue;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.triangles[face][k], row = (*normals.rows)[face][k];
      std::uint32_t sheet = first[row];
      for (int looked_at = 1; sheet != kNone && result.vertex[sheet] != vertex; ++looked_at)
        sheet = looked_at < kMostSheets ? next[sheet] : kNone;
      if (sheet == kNone) {
        sheet = static_cast<std::uint32_t>(result.vertex.size());
        const float* const n = &normals.values[3 * std::size_t{row}];
        result.vertex.push_back(vertex);
        result.normals.push_back({n[0], n[1], n[2]});
        next.push_back(std::exchange(first[row], sheet));
      }
      result.corner[face][k] = sheet;
    }
  }
  return result;
}

}  // namespace mesh

MeshAttribute smooth_normals(const Mesh& mesh, double crease) try {
  if (!(crease >= 0)) throw Error("the angle of creases must be at least 0 degrees");
  constexpr double kAnyCosine = -2, kHalfTurn = 180;
  const double cosine = crease >= kHalfTurn ? kAnyCosine : std::cos(crease * std::numbers::pi / kHalfTurn);
  mesh::SheetNormals sheets = mesh::sheet_normals(mesh, cosine);
  MeshAttribute normals{.name = "normal", .components = 3, .values = {}, .rows = nullptr};
  normals.values.reserve(3 * sheets.normals.size());
  for (const Vec3f& n : sheets.normals) normals.values.insert(normals.values.end(), n.begin(), n.end());
  normals.rows = std::make_shared<const std::vector<Triangle>>(std::move(sheets.corner));
  return normals;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the normals of a mesh");
}

}  // namespace sdm
