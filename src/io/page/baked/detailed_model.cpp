#include "io/page/baked/detailed_model.h"

#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <new>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/memory.h"
#include "geometry/triangle.h"
#include "geometry/vec.h"
#include "io/page/report/face_walk.h"
#include "io/page/report/fewer_vertices.h"

namespace sdm {
namespace io {
namespace {

constexpr std::size_t kMostTriangles = 250'000;
constexpr std::size_t kMostDivisions = 32;

/// Triangles between points of a mesh.
struct Parts {
  std::vector<SurfacePoint> points;
  std::vector<Triangle> triangles;
};

/// The corners of each face.
SurfacePoint corner_point(std::uint32_t face, std::size_t k) {
  SurfacePoint point{face, {}};
  point.barycentric[k] = 1;
  return point;
}

/// Every face as divisions² triangles.
Parts divided(const Mesh& mesh, std::size_t divisions) {
  const auto n = static_cast<std::uint32_t>(divisions);
  Parts parts;
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    if (!is_visible(mesh.triangles[face])) continue;
    const auto first = static_cast<std::uint32_t>(parts.points.size());
    // Row i has i + 1 points, from the side of corner 1 to that of corner 2.
    for (std::uint32_t i = 0; i <= n; ++i)
      for (std::uint32_t j = 0; j <= i; ++j)
        parts.points.push_back({face, {{1.0 * (n - i) / n, 1.0 * (i - j) / n, 1.0 * j / n}}});
    const auto at = [&](std::uint32_t i, std::uint32_t j) { return first + i * (i + 1) / 2 + j; };
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = 0; j <= i; ++j) {
        parts.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        if (j < i) parts.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  return parts;
}

/// A coarser copy, whose vertices are those of the mesh.
Parts coarser(const Mesh& mesh) {
  FewerVertices fewer = fewer_vertices(mesh, std::vector<float>(mesh.positions.size()), kMostTriangles);
  std::vector<SurfacePoint> point_of(mesh.positions.size());
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face)
    for (std::size_t k = 0; k < 3; ++k)
      if (SurfacePoint& point = point_of[mesh.triangles[face][k]];
          point.face == kNone && is_visible(mesh.triangles[face]))
        point = corner_point(face, k);
  Parts parts{.points = {}, .triangles = std::move(fewer.mesh.triangles)};
  for (const std::uint32_t vertex : fewer.vertex) parts.points.push_back(point_of[vertex]);
  return parts;
}

/// Whether no material is anything but rough and no metal, as Material is at first.
bool is_matt(const MeshLook& look) {
  return std::ranges::all_of(look.materials, [](const Material& material) {
    return material.metallic == 0 && material.roughness == 1;
  });
}

bool has_texture(const MeshLook& look) {
  return std::ranges::any_of(look.materials, [&](const Material& material) {
    const std::uint32_t texture = material.base_color_texture.texture;
    return texture < look.pictures.size() && look.pictures[texture].width > 0;
  });
}

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const auto [a, b, c] = corners_of(mesh, face);
    sum += norm(cross(b - a, c - a)) / 2;
  }
  return sum;
}

void require_normals(const Mesh& mesh, const MeshAttribute& normals) {
  const std::size_t rows = normals.values.size() / 3;
  const bool fits =
      normals.components == 3 && normals.rows && normals.rows->size() == mesh.triangles.size() &&
      std::ranges::all_of(*normals.rows, [&](const Triangle& of_face) {
        return std::ranges::all_of(of_face, [&](std::uint32_t row) { return row == kNone || row < rows; });
      });
  if (!fits) throw Error("the normals of the detailed mesh do not fit it");
}

/// That of the face where its corners have none.
std::uint32_t normal_at(const Mesh& mesh, const MeshAttribute& normals, const SurfacePoint& point) {
  Vec3 normal{};
  for (std::size_t k = 0; k < 3; ++k)
    if (const std::uint32_t row = (*normals.rows)[point.face][k]; row != kNone)
      for (std::size_t c = 0; c < 3; ++c)
        normal[c] += point.barycentric[k] * normals.values[3 * std::size_t{row} + c];
  if (!finite(normal) || normal == Vec3{}) {
    const auto [a, b, c] = corners_of(mesh, point.face);
    normal = cross(b - a, c - a);
  }
  if (normal == Vec3{}) normal = {0, 0, 1};
  normal = normalized(normal);
  return octahedral(
      {static_cast<float>(normal[0]), static_cast<float>(normal[1]), static_cast<float>(normal[2])});
}

/// Red, green and blue of a channel's picture at each point, 8 bits each, red the lowest.
std::vector<std::uint32_t> corner_values(const BakedFrom& from, const Parts& parts, BakeChannel channel) {
  // What a triangle of the page stands for.
  const double extent =
      std::sqrt(area_of(from.mesh) / static_cast<double>(std::max<std::size_t>(1, parts.triangles.size())));
  LookValues look = look_at(from.mesh, from.look, channel, parts.points, extent);
  const auto points = static_cast<std::uint32_t>(parts.points.size());
  const Image image = to_image({channel, points, look.components, std::move(look.values)});
  std::vector<std::uint32_t> values(points);
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      values[i] |= std::uint32_t{image.bytes[i * image.components + k]} << (8 * k);
  return values;
}

using Numbers = std::array<std::uint32_t, 6>;  ///< of a vertex: position, normal, colour, surface

struct HashOfNumbers {
  std::size_t operator()(const Numbers& numbers) const {
    std::uint64_t hash = 1469598103934665603u;  // FNV-1a
    for (const std::uint32_t number : numbers) hash = (hash ^ number) * 1099511628211u;
    return static_cast<std::size_t>(hash ^ hash >> 29);
  }
};

/// Points of equal numbers become one vertex.
std::vector<Numbers> join(std::vector<Triangle>& triangles, const std::vector<Numbers>& of_points) {
  std::unordered_map<Numbers, std::uint32_t, HashOfNumbers> known;
  std::vector<Numbers> vertices;
  std::vector<std::uint32_t> vertex_of;
  for (const Numbers& numbers : of_points) {
    const auto [place, is_new] = known.try_emplace(numbers, static_cast<std::uint32_t>(vertices.size()));
    if (is_new) vertices.push_back(numbers);
    vertex_of.push_back(place->second);
  }
  for (Triangle& triangle : triangles)
    for (std::uint32_t& vertex : triangle) vertex = vertex_of[vertex];
  std::erase_if(triangles, [](const Triangle& triangle) { return !is_visible(triangle); });
  return vertices;
}

Parts parts_of(const BakedFrom& from, nlohmann::ordered_json& counts) {
  const std::size_t faces = from.mesh.triangles.size();
  const bool fewer = faces > kMostTriangles;
  std::size_t divisions = 1;
  if (!fewer && faces > 0 && has_texture(from.look))
    divisions = std::clamp<std::size_t>(
        static_cast<std::size_t>(std::sqrt(static_cast<double>(kMostTriangles) / static_cast<double>(faces))),
        1, kMostDivisions);
  counts = {{"triangles_of_mesh", faces}, {"divisions", divisions}, {"fewer", fewer}};
  return fewer ? coarser(from.mesh) : divided(from.mesh, divisions);
}

std::vector<Numbers> numbers_of(const BakedFrom& from, const Parts& parts, const Steps& steps) {
  const Mesh& mesh = from.mesh;
  std::optional<MeshAttribute> smooth;
  if (from.normals == nullptr) smooth = smooth_normals(mesh);
  const MeshAttribute& normals = smooth ? *smooth : *from.normals;
  require_normals(mesh, normals);
  const std::vector<std::uint32_t> colors = corner_values(from, parts, BakeChannel::base_color);
  const std::vector<std::uint32_t> surfaces =
      is_matt(from.look) ? std::vector<std::uint32_t>(colors.size())
                         : corner_values(from, parts, BakeChannel::metallic_roughness);
  std::vector<Numbers> of_points(parts.points.size());
  for (std::size_t i = 0; i < of_points.size(); ++i) {
    const SurfacePoint& point = parts.points[i];
    const auto [a, b, c] = corners_of(mesh, point.face);
    const Vec3 at = point.barycentric[0] * a + point.barycentric[1] * b + point.barycentric[2] * c;
    of_points[i] = {steps(at, 0), steps(at, 1), steps(at, 2), normal_at(mesh, normals, point),
                    colors[i],    surfaces[i]};
  }
  return of_points;
}

Box box_of(const Mesh& o1, const Mesh& o2) {
  Box box = bounds(o1);
  for (const Vec3& p : o2.positions) extend(box, p);
  return box;
}

}  // namespace
}  // namespace io

DetailedView::DetailedView(const BakedFrom& from, const Mesh& o1) try {
  using namespace io;
  constexpr int kBitsOfPositions = 18;  // a quarter of a millimetre in a building
  auto data = std::make_shared<Data>(Data{.steps = Steps(box_of(o1, from.mesh), kBitsOfPositions)});
  Parts parts = parts_of(from, data->counts);
  const std::vector<Numbers> vertices = join(parts.triangles, numbers_of(from, parts, data->steps));
  const FaceWalk walk = walk_over(parts.triangles, vertices.size());
  std::vector<std::uint32_t> position, normal, color, surface;
  for (const std::uint32_t v : walk.vertex) {
    position.insert(position.end(), vertices[v].begin(), vertices[v].begin() + 3);
    normal.push_back(vertices[v][3]);
    color.push_back(vertices[v][4]);
    surface.push_back(vertices[v][5]);
  }
  data->arrays.add("high_triangle", corner_codes(walk.triangles));
  data->arrays.add_guessed("high_position", position, 3, guesses_of(walk.triangles));
  data->arrays.add("high_normal", std::move(normal));
  data->arrays.add("high_color", std::move(color));
  if (!is_matt(from.look)) data->arrays.add("high_surface", std::move(surface));
  data->counts["triangles"] = walk.triangles.size();
  data_ = std::move(data);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the page of a detailed mesh");
}

}  // namespace sdm
