#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "atlas/charts/face_geometry.h"
#include "atlas/charts/overlap.h"
#include "atlas/layout.h"
#include "geometry/vec.h"

namespace sdm::atlas {
namespace {

// Coordinates up to this far outside [0, 1], and overlaps up to this depth in texels, are attributed to
// rounding.
constexpr double kOutside = 1e-6;
constexpr double kTexelSlack = 1.0 / 1024;
constexpr double kLeastArea = 1e-12;  // square texels; below it the map to the surface is meaningless

[[noreturn]] void fail(const std::string& fault) {
  throw Error("the mesh's texture coordinates do not form an atlas: " + fault + "; use an atlas of charts",
              Remedy::atlas_kind);
}

std::array<Vec2, 3> placed(const std::array<Vec2, 3>& uvs, double columns, double rows) {
  std::array<Vec2, 3> corners;
  for (int k = 0; k < 3; ++k)
    corners[k] = {std::clamp(uvs[k][0], 0.0, 1.0) * columns, (1 - std::clamp(uvs[k][1], 0.0, 1.0)) * rows};
  return corners;
}

bool has_area(const std::array<Vec2, 3>& corners) {
  return std::abs(cross(corners[1] - corners[0], corners[2] - corners[0])) > kLeastArea;
}

// A line or a point of the texture as a triangle that is kSliver wide, towards the middle of the texture: its
// map to the surface is defined, and it is much too thin to own texels that others need.
std::array<Vec2, 3> sliver(std::array<Vec2, 3> corners, const Vec2& middle) {
  constexpr double kSliver = kTexelSlack / 4;
  const auto length = [&](int k) {
    const Vec2 side = corners[(k + 1) % 3] - corners[k];
    return std::hypot(side[0], side[1]);
  };
  const int from =
      length(0) >= length(1) ? (length(0) >= length(2) ? 0 : 2) : (length(1) >= length(2) ? 1 : 2);
  Vec2 &a = corners[from], &b = corners[(from + 1) % 3], &c = corners[(from + 2) % 3];
  if (length(from) < kSliver) b = a + Vec2{a[0] < middle[0] ? kSliver : -kSliver, 0};
  const Vec2 along = (1 / std::hypot(b[0] - a[0], b[1] - a[1])) * (b - a);
  Vec2 across{-along[1], along[0]};
  if (dot(across, middle - a) < 0) across = -1.0 * across;
  c = a + dot(c - a, along) * along + kSliver * across;
  return corners;
}

/// Returns the faces that have an area on the surface but none in the texture, ascending.
std::vector<std::uint32_t> place_corners(const Mesh& mesh, const FaceGeometry& faces, double columns,
                                         double rows, Layout& layout) {
  std::vector<std::uint32_t> without_area;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    if (faces.area[f] == 0) continue;
    for (const auto& [u, v] : mesh.corner_uvs[f])
      if (!(u >= -kOutside && u <= 1 + kOutside && v >= -kOutside && v <= 1 + kOutside))
        fail("those of face " + std::to_string(f) +
             " lie outside [0, 1], where they would have to be wrapped");
    layout.corners[f] = placed(mesh.corner_uvs[f], columns, rows);
    if (has_area(layout.corners[f])) continue;
    without_area.push_back(f);
    layout.corners[f] = sliver(layout.corners[f], {columns / 2, rows / 2});
  }
  return without_area;
}

// Every face visits its texels, whether others own them or not. Beyond these limits together, which are
// minutes of work, the map would have a value for few of the points that a texel stands for.
constexpr double kMostTexels = 1 << 30, kMostLayers = 64;

void check_layers(const FaceGeometry& faces, double columns, double rows, const Layout& layout) {
  double texels = 0, largest = 0;
  std::size_t face = 0;
  for (std::size_t f = 0; f < layout.corners.size(); ++f) {
    if (faces.area[f] == 0) continue;
    const auto& [a, b, c] = layout.corners[f];
    const double of_face = 0.5 * std::abs(cross(b - a, c - a));
    texels += of_face;
    if (of_face > largest) {
      largest = of_face;
      face = f;
    }
  }
  const double layers = texels / (columns * rows);
  if (texels > kMostTexels && layers > kMostLayers)
    fail("its faces, most of all face " + std::to_string(face) + ", cover the texture " +
         std::to_string(static_cast<std::uint64_t>(layers)) + " times over");
}

void check_overlaps(const FaceGeometry& faces, std::uint32_t longest, const Layout& layout) {
  const double steps_per_texel = static_cast<double>(kGridSteps) / longest;
  std::vector<GridTriangle> triangles;
  std::vector<std::uint32_t> face_of;
  for (std::uint32_t f = 0; f < layout.corners.size(); ++f) {
    if (faces.area[f] == 0) continue;
    GridTriangle t;
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 2; ++i)
        t[k][i] = static_cast<std::int32_t>(std::lround(layout.corners[f][k][i] * steps_per_texel));
    if (orientation(t[0], t[1], t[2]) < 0) std::swap(t[1], t[2]);
    triangles.push_back(t);
    face_of.push_back(f);
  }
  if (const auto pair = find_overlap(triangles, kTexelSlack * steps_per_texel))
    fail("faces " + std::to_string(face_of[pair->first]) + " and " + std::to_string(face_of[pair->second]) +
         " overlap");
}

// The larger singular value of the matrix with these columns.
double largest_stretch(const std::array<Vec3, 2>& edges) {
  const double e = squared_norm(edges[0]), f = dot(edges[0], edges[1]), g = squared_norm(edges[1]);
  return std::sqrt((e + g) / 2 + std::hypot((e - g) / 2, f));
}

// Whether faces f and g agree on the atlas coordinates of two vertices that they share.
bool joined(const Mesh& mesh, const Layout& layout, std::uint32_t f, std::uint32_t g) {
  int agreeing = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      agreeing +=
          mesh.triangles[f][i] == mesh.triangles[g][j] && layout.corners[f][i] == layout.corners[g][j];
  return agreeing >= 2;
}

// Faces without an area in the texture are charts of their own, after all others.
std::vector<std::vector<std::uint32_t>> uv_charts(const Mesh& mesh, const FaceGeometry& faces,
                                                  const Layout& layout,
                                                  std::span<const std::uint32_t> without_area) {
  std::vector<std::vector<std::uint32_t>> charts;
  std::vector<std::uint8_t> reached(mesh.triangles.size(), 0);
  for (const std::uint32_t f : without_area) reached[f] = 1;
  for (std::uint32_t seed = 0; seed < reached.size(); ++seed) {
    if (reached[seed] || faces.area[seed] == 0) continue;
    std::vector<std::uint32_t>& chart = charts.emplace_back(1, seed);
    reached[seed] = 1;
    for (std::size_t i = 0; i < chart.size(); ++i)
      for (const std::uint32_t next : faces.neighbours[chart[i]])
        if (next != kNone && !reached[next] && faces.area[next] > 0 && joined(mesh, layout, chart[i], next)) {
          reached[next] = 1;
          chart.push_back(next);
        }
  }
  for (const std::uint32_t f : without_area) charts.emplace_back(1, f);
  return charts;
}

}  // namespace

bool is_sliver(const std::array<Vec2, 3>& corners, const std::array<Vec2, 3>& uvs, std::uint32_t columns,
               std::uint32_t rows) {
  const std::array<Vec2, 3> at = placed(uvs, columns, rows);
  for (int k = 0; k < 3; ++k)
    if (std::hypot(corners[k][0] - at[k][0], corners[k][1] - at[k][1]) > kTexelSlack) return false;
  return !has_area(at);
}

Layout uv_layout(const Mesh& mesh, const AtlasOptions& options) {
  if (mesh.corner_uvs.empty()) fail("not every corner of every face has them");
  const FaceGeometry faces = face_geometry(mesh);
  Layout layout;
  layout.corners.resize(mesh.triangles.size());
  layout.maps.resize(mesh.triangles.size());
  const std::uint32_t columns = options.resolution, rows = options.rows.value_or(columns);
  const std::vector<std::uint32_t> without_area = place_corners(mesh, faces, columns, rows, layout);
  if (options.strict_uv && !without_area.empty())
    fail("face " + std::to_string(without_area.front()) +
         " has an area on the surface but none in the texture");
  check_layers(faces, columns, rows, layout);
  if (options.strict_uv) check_overlaps(faces, std::max(columns, rows), layout);

  double surface_area = 0, atlas_area = 0, largest = 0;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    if (faces.area[f] == 0) continue;
    const auto& uv = layout.corners[f];
    layout.maps[f] = {uv[0], affine_edges(uv, mesh.positions, mesh.triangles[f])};
    surface_area += faces.area[f];
    atlas_area += 0.5 * std::abs(cross(uv[1] - uv[0], uv[2] - uv[0]));
    if (std::ranges::binary_search(without_area, f)) continue;
    largest = std::max(largest, largest_stretch(layout.maps[f].edges));
  }
  layout.scale = std::sqrt(atlas_area / surface_area);
  layout.max_stretch = largest / std::sqrt(surface_area / atlas_area);
  layout.charts = uv_charts(mesh, faces, layout, without_area);
  return layout;
}

}  // namespace sdm::atlas
