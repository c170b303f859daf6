#include <sdm/error.h>

#include <algorithm>

#include "atlas/charts/pairs.h"
#include "atlas/charts/rough.h"
#include "atlas/charts/shape.h"
#include "atlas/charts/split.h"
#include "atlas/layout.h"
#include "atlas/packing/fit.h"
#include "atlas/packing/pack.h"
#include "core/parallel.h"
#include "geometry/vec.h"

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

}  // namespace

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

}  // namespace sdm::atlas
