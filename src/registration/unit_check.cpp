#include <sdm/doubts.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/larger_units.h"
#include "geometry/vec.h"
#include "mesh/validate.h"
#include "registration/correspondences.h"
#include "registration/samples.h"

namespace sdm {
namespace {

constexpr std::size_t kUnitSamples = 1024;
constexpr double kFits = 0.02, kMuchBetter = 0.25;  // misfits, as fractions of the radius of gyration

double misfit_of(const Alignment& alignment) {
  return alignment.gyration_radius > 0 ? alignment.after.rms / alignment.gyration_radius : 0;
}

std::optional<OtherUnit> best_unit(const registration::Samples& samples, const Sites& o2,
                                   const Alignment& found, AlignOptions options) {
  constexpr double kAcceptable = 0.1;
  constexpr double kTooLarge = 2;  // times the size of O2: most of O1 would be far from it
  const double as_given = misfit_of(found);
  if (!(as_given > kFits)) return std::nullopt;
  OtherUnit best{.misfit = std::min(kMuchBetter * as_given, kAcceptable), .misfit_as_given = as_given};
  Box box;
  for (const Vec3& p : samples.points) extend(box, p);
  const double size = diagonal(box), most = kTooLarge * diagonal(bounds(o2.mesh()));
  options.samples = kUnitSamples;
  if (options.start == AlignStart::automatic) options.start = AlignStart::pose;
  for (const auto& [ratio, name] : kLargerUnits)
    for (const double factor : {ratio, 1 / ratio}) {
      if (!(factor * size <= most)) continue;
      std::vector<Vec3> scaled = samples.points;
      for (Vec3& p : scaled) p = factor * p;
      const double misfit = misfit_of(align(scaled, samples.normals, o2, options));
      if (misfit < best.misfit) {
        best.factor = factor;
        best.misfit = misfit;
      }
    }
  return best.factor != 1 ? std::optional(best) : std::nullopt;
}

std::vector<Vec3> times(double factor, std::span<const Vec3> points) {
  std::vector<Vec3> scaled(points.begin(), points.end());
  for (Vec3& p : scaled) p = factor * p;
  return scaled;
}

Box box_of(std::span<const Vec3> points) {
  Box box;
  for (const Vec3& p : points) extend(box, p);
  return box;
}

/// The root of the mean squared distance of the points to their mean.
double gyration_radius(std::span<const Vec3> points) {
  Vec3 mean{};
  for (const Vec3& p : points) mean += (1.0 / static_cast<double>(points.size())) * p;
  double sum = 0;
  for (const Vec3& p : points) sum += squared_norm(p - mean);
  return std::sqrt(sum / static_cast<double>(points.size()));
}

double misfit_in_place(const registration::Samples& samples, const registration::Target& o2) {
  const registration::Correspondences pairs = registration::find_correspondences(samples, {}, o2);
  double sum = 0;
  for (const double d : pairs.distances) sum += d * d;
  const double radius = gyration_radius(samples.points);
  return radius > 0 ? std::sqrt(sum / static_cast<double>(samples.points.size())) / radius : 0;
}

/// How far the corners of both boxes are from each other at most along an axis, as a fraction of the second
/// one's diagonal.
double distance_of_corners(const Box& a, const Box& b) {
  double most = 0;
  for (int k = 0; k < 3; ++k)
    most = std::max({most, std::abs(a.lower[k] - b.lower[k]), std::abs(a.upper[k] - b.upper[k])});
  return most / diagonal(b);
}

/// Throws sdm::Error. A mesh in motion has the places of removed faces.
void validate_in_place(const Mesh& mesh) {
  if (std::ranges::any_of(mesh.triangles, is_removed))
    mesh::validate_edited(mesh);
  else
    validate(mesh);
}

Mesh without_removed_faces(Mesh mesh) {
  std::erase_if(mesh.triangles, is_removed);
  return mesh;
}

/// `box`: of all of O1, which the samples are taken from.
std::optional<OtherUnit> unit_in_place(const registration::Samples& samples, const Box& box, const Mesh& o2) {
  constexpr double kSame = 0.05, kFar = 1;
  const Box to = bounds(o2);
  const Sites sites(without_removed_faces(o2));
  const registration::Target target(sites);
  const double as_given = misfit_in_place(samples, target);
  std::optional<OtherUnit> best;
  double least = as_given > kFits ? std::min(kMuchBetter * as_given, kFits) : 0;
  for (const auto& [ratio, name] : kLargerUnits)
    for (const double factor : {ratio, 1 / ratio}) {
      const double apart = distance_of_corners({factor * box.lower, factor * box.upper}, to);
      const bool same = apart <= kSame;
      if (!same && !(least > 0 && apart <= kFar)) continue;
      const double misfit = misfit_in_place({times(factor, samples.points), samples.normals}, target);
      const OtherUnit unit{factor, misfit, as_given, same};
      if (same) return unit;
      if (misfit <= least) {
        best = unit;
        least = misfit;
      }
    }
  return best;
}

}  // namespace

std::optional<OtherUnit> find_other_unit(const Mesh& o1, const Sites& o2, const Alignment& found,
                                         const AlignOptions& options) {
  validate(o1);
  return best_unit(registration::surface_source(o1)(kUnitSamples), o2, found, options);
}

std::optional<OtherUnit> find_other_unit(std::span<const Vec3> points, std::span<const Vec3> normals,
                                         const Sites& o2, const Alignment& found,
                                         const AlignOptions& options) {
  return best_unit(registration::cloud_source(points, normals)(kUnitSamples), o2, found, options);
}

bool sizes_differ(const Box& a, const Box& b) {
  constexpr double kRatio = 5;  // less than that of any two units, as O1 may be a part of O2
  const double first = diagonal(a), second = diagonal(b);
  return first > kRatio * second || second > kRatio * first;
}

std::optional<OtherUnit> find_other_unit_in_place(const Mesh& o1, const Mesh& o2) {
  validate_in_place(o1);
  validate_in_place(o2);
  const Box box = bounds(o1);
  if (!sizes_differ(box, bounds(o2))) return std::nullopt;
  return unit_in_place(registration::surface_source(o1)(kUnitSamples), box, o2);
}

std::optional<OtherUnit> find_other_unit_in_place(std::span<const Vec3> points, const Mesh& o2) {
  validate(o2);
  const Box box = box_of(points);
  if (points.empty() || !sizes_differ(box, bounds(o2))) return std::nullopt;
  return unit_in_place(registration::cloud_source(points, {})(kUnitSamples), box, o2);
}

}  // namespace sdm
