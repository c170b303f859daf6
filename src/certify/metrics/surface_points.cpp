#include "certify/metrics/surface_points.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>

#include "certify/hausdorff/vertex_search.h"
#include "core/numbers/compensated_sum.h"
#include "geometry/rounding.h"
#include "geometry/spatial_order.h"
#include "geometry/triangle.h"

namespace sdm::metrics {
namespace {

constexpr std::size_t kPointsOfRun = 4096;

}  // namespace

SurfacePoints::SurfacePoints(const Mesh& mesh) : mesh_(mesh) {
  std::vector<std::uint32_t> faces;
  std::vector<Vec3> middles;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    if (hausdorff::repeats_corner(mesh.triangles[f])) continue;
    const auto [p, q, r] = corners_of(mesh, f);
    faces.push_back(f);
    middles.push_back((1.0 / 3) * (p + q + r));
  }
  CompensatedSum area, error;
  for (const std::uint32_t i : spatial_order(middles)) {
    const auto [part, rounding] = area_of(corners_of(mesh, faces[i]));
    if (!(part > 0)) continue;
    area += part;
    error += rounding;
    faces_.push_back(faces[i]);
    end_.push_back(area.value());
  }
  if (faces_.empty()) throw Error("the faces of a mesh have no area: there are no average distances");
  area_ = area.value();
  rounding_ = kDoubleRounding + 2 * error.value() / area_;
}

SurfacePoints::Place SurfacePoints::place(double along, double u, double v, std::size_t count) const {
  const double at = along * area_;
  const std::size_t i =
      std::min<std::size_t>(std::ranges::upper_bound(end_, at) - end_.begin(), faces_.size() - 1);
  const double begin = i == 0 ? 0 : end_[i - 1], length = end_[i] - begin;
  auto [a, b, c] = corners_of(mesh_, faces_[i]);
  double rest = (at - begin) / length;
  // The line runs through parts of the face with some points each. A point is anywhere in its part.
  constexpr int kSomePoints = 3, kMostHalvings = 24;  // 2³ points
  const double points = static_cast<double>(count) * length / area_;
  const int halvings = points > 1 ? std::min(std::ilogb(points) - kSomePoints, kMostHalvings) : 0;
  for (int n = 0; n < halvings; ++n) {
    const Vec3 middle = 0.5 * (b + c), apex = a;
    rest *= 2;
    if (rest < 1) {
      a = middle;
      c = b;
      b = apex;
    } else {
      a = middle;
      b = c;
      c = apex;
      rest -= 1;
    }
  }
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return {a + u * (b - a) + v * (c - a), faces_[i]};
}

// How many points each part of the line has, of the same length, is decided by as many random numbers; where
// they are in it by others.
SurfacePoints::Runs::Runs(const SurfacePoints& surface, std::size_t count, std::uint64_t seed,
                          std::uint64_t stream)
    : surface_(surface), numbers_(seed, stream), first_((count + kPointsOfRun - 1) / kPointsOfRun + 1) {
  const auto runs = static_cast<double>(size());
  for (std::uint64_t i = 0; i < count; ++i) ++first_[static_cast<std::size_t>(runs * numbers_.at(i)) + 1];
  for (std::size_t r = 0; r < size(); ++r) first_[r + 1] += first_[r];
}

void SurfacePoints::Runs::place(std::size_t run, std::vector<Place>& places) const {
  const std::size_t all = first_.back(), begin = first_[run], end = first_[run + 1];
  std::vector<double> along;
  along.reserve(end - begin);
  for (std::size_t i = begin; i < end; ++i) along.push_back(numbers_.at(all + i));
  std::ranges::sort(along);
  places.clear();
  for (std::size_t i = begin; i < end; ++i) {
    const double at = (static_cast<double>(run) + along[i - begin]) / static_cast<double>(size());
    places.push_back(surface_.place(at, numbers_.at(2 * all + i), numbers_.at(3 * all + i), all));
  }
}

}  // namespace sdm::metrics
