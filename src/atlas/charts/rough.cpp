#include "atlas/charts/rough.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "atlas/charts/cluster.h"
#include "atlas/charts/overlap.h"
#include "core/arrays/rows.h"
#include "core/parallel.h"

namespace sdm::atlas {
namespace {

// A surface is rough from so many first clusters on: as many gutters, of so many texels each, fill the atlas.
constexpr std::size_t kFewClusters = 4096;
constexpr std::uint64_t kTexelsPerGutter = 170;
// Where first clusters have more texels each, what stretched faces lose is more than what fewer gutters gain.
constexpr std::uint64_t kTexelsPerCluster = 72;
// A smoothed surface has fewer clusters than one for so many faces. Triangles that share nothing have more.
constexpr std::size_t kFacesPerCluster = 32;
// The first clusters of a rough surface are more than so many for one of the smoothed surface. A smooth one
// has fewer.
constexpr std::size_t kFewerClusters = 2;
// Smoothed normals are within 25° of the axis of a chart, so that the faces have room to be steeper than
// these.
constexpr double kCosSmooth = 0.9063;
// The least steep faces that a chart loses are those beyond this share; but their stretch is between these.
constexpr double kShareTooSteep = 0.0075, kLeastLimit = 2.25, kMostLimit = 4;

/// Each pass adds up the area vectors of the faces around each vertex, and those of the vertices of each
/// face. The area vectors of a patch add up to a vector of its boundary alone: noise inside of it cancels.
std::vector<Vec3> smoothed_normals(const Mesh& mesh, const FaceGeometry& faces) {
  constexpr int kPasses = 4;
  constexpr std::size_t kAtOnce = 4096;
  const std::size_t count = mesh.triangles.size();
  const auto around = make_rows<std::uint32_t>(mesh.positions.size(), [&](const auto& put) {
    for (std::uint32_t f = 0; f < count; ++f)
      if (faces.area[f] > 0)
        for (const std::uint32_t v : mesh.triangles[f]) put(v, f);
  });
  const double largest = std::ranges::max(faces.area);
  std::vector<Vec3> at_face(count), at_vertex(mesh.positions.size());
  const auto for_each = [](std::size_t number, const auto& compute) {
    parallel_for(number, kAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) compute(i);
    });
  };
  for_each(count, [&](std::size_t f) { at_face[f] = (faces.area[f] / largest) * faces.normal[f]; });
  for (int pass = 0; pass < kPasses; ++pass) {
    for_each(at_vertex.size(), [&](std::size_t v) {
      at_vertex[v] = {};
      for (const std::uint32_t f : around.of(v)) at_vertex[v] += at_face[f];
    });
    for_each(count, [&](std::size_t f) {
      const auto [i, j, k] = mesh.triangles[f];
      if (faces.area[f] > 0) at_face[f] = (1.0 / 16) * (at_vertex[i] + at_vertex[j] + at_vertex[k]);
    });
  }
  for_each(count, [&](std::size_t f) {
    const double length = norm(at_face[f]);
    at_face[f] = length > 0 ? (1 / length) * at_face[f] : faces.normal[f];
  });
  return at_face;
}

/// The faces that leave the charts of the smoothed surface, and the charts of what stays.
class RoughCharts {
 public:
  RoughCharts(const Mesh& mesh, const FaceGeometry& faces, std::vector<Chart> charts)
      : mesh_(mesh), faces_(faces), charts_(std::move(charts)), out_(mesh.triangles.size(), 0) {
    cos_limit_ = cos_limit();
  }

  std::vector<Chart> run(double cos_angle) {
    std::vector<std::vector<Chart>> parts(charts_.size());
    parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) {
        take_out_steep(charts_[c]);
        take_out_folds(charts_[c]);
        parts[c] = large_parts(charts_[c]);
      }
    });
    std::vector<Chart> result;
    for (std::vector<Chart>& list : parts) std::ranges::move(list, std::back_inserter(result));
    std::ranges::move(charts_of_rest(cos_angle), std::back_inserter(result));
    return result;
  }

 private:
  [[nodiscard]] double cosine(const Chart& chart, std::uint32_t face) const {
    return dot(faces_.normal[face], chart.axis);
  }

  // The least cosine of the angle between the axis of a chart and the normal of a face that stays.
  [[nodiscard]] double cos_limit() const {
    std::vector<float> cosines;
    for (const Chart& chart : charts_)
      for (const std::uint32_t f : chart.faces) cosines.push_back(static_cast<float>(cosine(chart, f)));
    const auto at = static_cast<std::ptrdiff_t>(kShareTooSteep * static_cast<double>(cosines.size()));
    std::ranges::nth_element(cosines, cosines.begin() + at);
    return std::clamp(1.0 * cosines[static_cast<std::size_t>(at)], 1 / kMostLimit, 1 / kLeastLimit);
  }

  void take_out_steep(Chart& chart) {
    for (const std::uint32_t f : chart.faces) out_[f] = cosine(chart, f) < cos_limit_;
    std::erase_if(chart.faces, [&](std::uint32_t f) { return out_[f] != 0; });
  }

  // Where two faces overlap because the surface is folded there, the steeper one leaves. Parts of the chart
  // that overlap otherwise are for split_overlaps(), as is a chart that cannot be tested within the budget.
  void take_out_folds(Chart& chart) {
    constexpr std::size_t kMostFolds = 4;  // one of so many faces
    if (chart.faces.size() < 2) return;
    const std::size_t count = chart.faces.size();
    for (const auto& [i, j] : find_overlaps(snap(mesh_, chart), count / kMostFolds, pair_budget(count))) {
      const std::uint32_t a = chart.faces[i], b = chart.faces[j];
      if (out_[a] == 0 && out_[b] == 0 && are_close(a, b))
        out_[cosine(chart, a) < cosine(chart, b) ? a : b] = 1;
    }
    std::erase_if(chart.faces, [&](std::uint32_t f) { return out_[f] != 0; });
  }

  [[nodiscard]] bool are_close(std::uint32_t a, std::uint32_t b) const {
    constexpr double kMaxDistance = 4;
    const double max_distance = kMaxDistance * (std::sqrt(faces_.area[a]) + std::sqrt(faces_.area[b]));
    return norm(faces_.centroid[a] - faces_.centroid[b]) < max_distance;
  }

  // The connected parts of many faces. The faces of the others leave: an island in a hole of the chart,
  // smaller than a texel, would own none.
  std::vector<Chart> large_parts(const Chart& chart) {
    constexpr std::size_t kLarge = 16;
    std::vector<Chart> parts;
    std::vector<std::uint8_t> visited(chart.faces.size(), 0);
    const auto visit = [&](std::uint32_t face) {
      const auto at = std::ranges::lower_bound(chart.faces, face);
      if (at == chart.faces.end() || *at != face) return false;
      return std::exchange(visited[static_cast<std::size_t>(at - chart.faces.begin())], std::uint8_t{1}) == 0;
    };
    for (const std::uint32_t seed : chart.faces) {
      if (!visit(seed)) continue;
      Chart part{chart.axis, {seed}};
      for (std::size_t i = 0; i < part.faces.size(); ++i)
        for (const std::uint32_t next : faces_.neighbours[part.faces[i]])
          if (next != kNone && visit(next)) part.faces.push_back(next);
      if (part.faces.size() < kLarge) {
        for (const std::uint32_t f : part.faces) out_[f] = 1;
        continue;
      }
      std::ranges::sort(part.faces);
      parts.push_back(std::move(part));
    }
    return parts;
  }

  // The charts of the faces that have left, by their own normals.
  [[nodiscard]] std::vector<Chart> charts_of_rest(double cos_angle) const {
    std::vector<std::uint32_t> rest;
    for (std::uint32_t f = 0; f < out_.size(); ++f)
      if (out_[f] != 0) rest.push_back(f);
    const auto number = [&](std::uint32_t f) {
      const auto at = std::ranges::lower_bound(rest, f);
      return at != rest.end() && *at == f ? static_cast<std::uint32_t>(at - rest.begin()) : kNone;
    };
    if (rest.empty()) return {};
    Mesh part;
    part.positions = mesh_.positions;
    FaceGeometry geometry;
    for (const std::uint32_t f : rest) {
      part.triangles.push_back(mesh_.triangles[f]);
      geometry.normal.push_back(faces_.normal[f]);
      geometry.area.push_back(faces_.area[f]);
      geometry.centroid.push_back(faces_.centroid[f]);
      for (std::uint32_t& next : geometry.neighbours.emplace_back(faces_.neighbours[f]))
        if (next != kNone) next = number(next);
    }
    std::vector<Chart> charts = *cluster_faces(part, geometry, cos_angle).charts;
    for (Chart& chart : charts)
      for (std::uint32_t& f : chart.faces) f = rest[f];
    return charts;
  }

  const Mesh& mesh_;
  const FaceGeometry& faces_;
  std::vector<Chart> charts_;
  std::vector<std::uint8_t> out_;  ///< of each face: whether it has left
  double cos_limit_;
};

}  // namespace

Clusters cluster_rough_faces(const Mesh& mesh, const FaceGeometry& faces, double cos_angle,
                             std::uint32_t resolution) {
  const std::uint64_t texels = std::uint64_t{resolution} * resolution;
  const std::size_t rough = std::max<std::size_t>(kFewClusters, texels / kTexelsPerGutter);
  // Many clusters at smaller angles are no sign of noise: smooth surfaces have as many.
  auto [first, charts] = cluster_faces(mesh, faces, cos_angle, cos_angle > kCosSmooth ? SIZE_MAX : rough);
  if (charts) return {std::move(*charts)};
  FaceGeometry smooth = faces;
  smooth.normal = smoothed_normals(mesh, faces);
  const std::size_t too_many = std::min(faces.area.size() / kFacesPerCluster, first / kFewerClusters);
  auto smoothed = cluster_faces(mesh, smooth, kCosSmooth, too_many);
  if (!smoothed.charts || first < texels / kTexelsPerCluster)
    return {*cluster_faces(mesh, faces, cos_angle).charts, smoothed.charts.has_value()};
  return {RoughCharts(mesh, faces, std::move(*smoothed.charts)).run(cos_angle), true};
}

}  // namespace sdm::atlas
