#include "atlas/layout.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "atlas/charts/face_geometry.h"
#include "atlas/charts/overlap.h"
#include "atlas/charts/pairs.h"
#include "atlas/charts/rough.h"
#include "atlas/charts/shape.h"
#include "atlas/charts/split.h"
#include "atlas/packing/fit.h"
#include "atlas/packing/pack.h"
#include "core/parallel.h"

namespace sdm::atlas {
namespace {

// Larger values would not improve the charts, and this one keeps their axes well away from the planes of
// their faces.
constexpr double kMaxStretch = 100;

void report(const Progress& progress, double fraction) {
  if (progress && !progress("atlas", fraction)) throw Cancelled();
}

// Shares of the time at which the steps end, roughly.
constexpr double kClustered = 0.3, kSplit = 0.4, kPacked = 0.95;

Progress packing_progress(const Progress& progress) {
  if (!progress) return {};
  return [&progress](std::string_view, double fraction) {
    return progress("atlas", kSplit + fraction * (kPacked - kSplit));
  };
}

// The projection of a chart followed by its placement maps onto the unit vectors right and down of the
// chart's plane, times the scale s. For the inverse, p moves in the face's plane, with normal n, so that its
// projection along the axis moves by right / s: ∂p/∂u = (right − axis (n·right)/(n·axis)) / s, and ∂p/∂v
// likewise. Well conditioned for any sliver, as n·axis ≥ cos θ; the singular values are 1/s and 1/(s n·axis).
std::array<Vec3, 2> lifted(const std::array<Vec3, 2>& plane, double scale, const Vec3& axis,
                           const Vec3& normal) {
  const auto lift = [&](const Vec3& e) {
    return (1 / scale) * (e - dot(normal, e) / dot(normal, axis) * axis);
  };
  return {lift(plane[0]), lift(plane[1])};
}

double scale_of(const Placement& placement) {
  return std::hypot(placement.matrix[0][0], placement.matrix[0][1]);
}

Clusters make_charts(const Mesh& mesh, const FaceGeometry& faces, const AtlasOptions& options) {
  if (options.kind == AtlasKind::triangles) return {pair_faces(mesh, faces)};
  auto [charts, rough] =
      cluster_rough_faces(mesh, faces, 1 / std::min(options.max_stretch, kMaxStretch), options.resolution);
  report(options.progress, kClustered);
  return {split_overlaps(mesh, faces, std::move(charts)), rough};
}

Layout placed_charts(const Mesh& mesh, const FaceGeometry& faces, std::vector<Chart> charts,
                     std::span<const Shape> shapes, std::span<const Placement> placements) {
  Layout layout;
  layout.maps.resize(mesh.triangles.size());
  layout.corners.resize(mesh.triangles.size());
  layout.charts.resize(charts.size());
  std::vector<double> least_cos(charts.size(), 1);
  parallel_for(charts.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const auto& [matrix, offset] = placements[c];
      const double scale = scale_of(placements[c]);
      const auto plane = [&](const ShapeFrame& frame) {
        std::array<Vec3, 2> axes;
        for (int k = 0; k < 2; ++k)
          axes[k] = (1 / scale) * (matrix[k][0] * frame.right + matrix[k][1] * frame.down);
        return axes;
      };
      const std::array<Vec3, 2> projected = plane(shapes[c].frame), unfolded = plane(shapes[c].unfolded);
      const bool pair = charts[c].unfolded;
      for (std::size_t i = 0; i < charts[c].faces.size(); ++i) {
        const std::uint32_t f = charts[c].faces[i];
        for (int k = 0; k < 3; ++k) layout.corners[f][k] = placements[c].apply(shapes[c].triangles[i][k]);
        layout.maps[f] = {layout.corners[f][0],
                          pair && i == 1 ? lifted(unfolded, scale, faces.normal[f], faces.normal[f])
                                         : lifted(projected, scale, charts[c].axis, faces.normal[f])};
        if (charts[c].faces.size() > 1 && !pair)
          least_cos[c] = std::min(least_cos[c], dot(faces.normal[f], charts[c].axis));
      }
      layout.charts[c] = std::move(charts[c].faces);
    }
  });
  for (const double cos : least_cos) layout.max_stretch = std::max(layout.max_stretch, 1 / cos);
  return layout;
}

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

std::array<Vec3, 2> affine_edges(const std::array<Vec2, 3>& corners, std::span<const Vec3> positions,
                                 const Triangle& t) {
  const Vec3 &origin = positions[t[0]], first = positions[t[1]] - origin, second = positions[t[2]] - origin;
  const Vec2 a = corners[1] - corners[0], b = corners[2] - corners[0];
  const double det = cross(a, b);
  return {(1 / det) * (b[1] * first - a[1] * second), (1 / det) * (a[0] * second - b[0] * first)};
}

bool is_needle(const std::array<Vec2, 3>& corners) {
  const Vec2 a = corners[1] - corners[0], b = corners[2] - corners[0], c = corners[2] - corners[1];
  constexpr double kThin = 3e-8;  // of a side, about the root of what rounded products are off by
  return std::abs(cross(a, b)) <= kThin * std::max({dot(a, a), dot(b, b), dot(c, c)});
}

std::array<Vec3, 2> moved_edges(const std::array<Vec2, 3>& corners, std::span<const Vec3> positions,
                                const Triangle& t) {
  if (!is_needle(corners)) return affine_edges(corners, positions, t);
  std::array<Vec3, 2> edges{};
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Vec2 side = corners[next] - corners[k];
    const double squared = dot(side, side);
    if (squared <= longest) continue;
    longest = squared;
    const Vec3 moved = positions[t[next]] - positions[t[k]];
    edges = {side[0] / squared * moved, side[1] / squared * moved};
  }
  return edges;
}

Layout chart_layout(const Mesh& mesh, const AtlasOptions& options) {
  report(options.progress, 0);
  const FaceGeometry faces = face_geometry(mesh);
  auto [charts, rough] = make_charts(mesh, faces, options);
  report(options.progress, kSplit);
  const std::vector<Shape> shapes = chart_shapes(mesh, faces, charts);
  const std::vector<Placement> placements =
      pack(shapes, {options.resolution, options.gutter, rough}, packing_progress(options.progress));
  Layout layout = placed_charts(mesh, faces, std::move(charts), shapes, placements);
  layout.scale = scale_of(placements.front());
  report(options.progress, 1);
  return layout;
}

Layout added_layout(const Mesh& added, const AtlasOptions& options, double scale, Room& room) {
  const FaceGeometry faces = face_geometry(added);
  std::vector<Chart> charts;
  if (std::ranges::any_of(faces.area, [](double area) { return area > 0; }))
    charts = make_charts(added, faces, options).charts;
  const std::vector<Shape> shapes = chart_shapes(added, faces, charts);
  const std::vector<Placement> placements = fit(shapes, scale, room);
  Layout layout = placed_charts(added, faces, std::move(charts), shapes, placements);
  layout.scale = scale;
  for (const std::vector<std::uint32_t>& chart : layout.charts)
    for (const std::uint32_t face : chart) room.add(layout.corners[face]);
  return layout;
}

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
