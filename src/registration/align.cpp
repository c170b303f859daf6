#include <sdm/align.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <string>

#include "core/memory.h"
#include "geometry/vec.h"
#include "mesh/similarity.h"
#include "mesh/validate.h"
#include "registration/correspondences.h"
#include "registration/freedoms.h"
#include "registration/point_to_plane.h"
#include "registration/principal_axes.h"
#include "registration/samples.h"

namespace sdm {
namespace {

using namespace registration;

constexpr std::size_t kCoarse = 1024;  // samples of the first level
constexpr double kEverything = std::numeric_limits<double>::infinity();
constexpr std::size_t kThin = 4096;  // samples that show which motions are determined

/// The state of a registration: a pose of samples that are relative to their centre.
struct Fit {
  Affine pose;
  double cut = kEverything;
  int iterations = 0;
  bool converged = false;
};

void check_progress(const AlignOptions& options, double fraction) {
  if (options.progress && !options.progress("align", fraction)) throw Cancelled();
}

Affine rigid(const Transform& pose) {
  constexpr double kTolerance = 1e-5;  // as of single precision, with room for a product of several
  mesh::Similarity similarity;
  try {
    similarity = mesh::Similarity::of(pose);
  } catch (const Error&) {
    similarity.scale = 0;
  }
  if (!(std::abs(similarity.scale - 1) <= kTolerance))
    throw Error("the pose to start the alignment at is not a rotation and a translation");
  for (Vec3& row : similarity.map.rows) row = (1 / similarity.scale) * row;
  return similarity.map;
}

/// Steps until one is shorter than `tolerance`, relative to `radius`.
Fit refine(const Samples& samples, Fit fit, double radius, const Target& target, int most, double tolerance) {
  const Pivot pivot{fit.pose.offset, radius};
  fit.converged = false;
  Motions motions;
  for (int step = 0; step < most && !fit.converged; ++step, ++fit.iterations) {
    const Correspondences pairs = find_correspondences(samples, fit.pose, target);
    if (step == 0) motions = determined_motions(thinned(pairs, kThin), target.sites, pivot, kEverything);
    fit.cut = trimming_cut(pairs, pivot, motions);
    const Motion motion = best_motion(pairs, pivot, motions, fit.cut);
    fit.pose = moved(fit.pose, pivot, motion);
    fit.converged = motion.norm() < tolerance * radius;
  }
  return fit;
}

/// The mean distance, of which each counts at most a tenth of the radius: small features decide between poses
/// of a nearly symmetric part, and outliers do not.
double mismatch(const Samples& samples, const Affine& pose, double radius, const Target& target) {
  constexpr double kMost = 0.1;
  double sum = 0;
  for (const double d : find_correspondences(samples, pose, target).distances)
    sum += std::min(d, kMost * radius);
  return sum / static_cast<double>(samples.points.size());
}

Fit best_match_of_axes(const Samples& samples, double radius, const Target& target,
                       const AlignOptions& options) {
  constexpr std::size_t kSamples = 4096;
  constexpr int kSteps = 15;
  constexpr double kTolerance = 1e-3, kGood = 0.01;
  const AxisMatches candidates =
      axis_matches(samples.points, surface_source(target.sites.mesh())(kSamples).points);
  double least = kEverything;
  Fit best;
  for (std::size_t i = 0; i < candidates.poses.size(); ++i) {
    if (i >= candidates.likely && least < kGood * radius) break;
    check_progress(options, static_cast<double>(i) / static_cast<double>(candidates.poses.size()));
    const Fit fit = refine(samples, {candidates.poses[i]}, radius, target, kSteps, kTolerance);
    if (const double found = mismatch(samples, fit.pose, radius, target); found < least)
      least = found, best = fit;
  }
  return best;
}

AlignResiduals residuals(std::vector<double> distances, double fraction_used) {
  std::ranges::sort(distances);
  const auto used =
      static_cast<std::size_t>(std::round(fraction_used * static_cast<double>(distances.size())));
  AlignResiduals result;
  double sum = 0;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    sum += distances[i] * distances[i];
    if (i + 1 == used) result.trimmed_rms = std::sqrt(sum / static_cast<double>(used));
  }
  result.rms = std::sqrt(sum / static_cast<double>(distances.size()));
  return result;
}

Samples relative(Samples samples, const Vec3& centre) {
  for (Vec3& p : samples.points) p = p - centre;
  return samples;
}

Alignment align_samples(const SampleSource& source, const Sites& o2, const AlignOptions& options) {
  constexpr double kCoarseTolerance = 1e-4, kTolerance = 1e-6;
  if (options.samples < 64) throw Error("an alignment needs at least 64 samples");
  if (options.max_iterations < 1) throw Error("the number of iterations must be greater than 0");
  const Affine start = rigid(options.pose);
  check_progress(options, 0);

  const Target target(o2);
  const Samples given = source(options.samples);
  const auto [centre, extent] = robust_extent(given.points);
  const double radius = extent > 0 ? extent : 1;
  const Samples fine = relative(given, centre);
  const Samples coarse = relative(source(std::min(kCoarse, options.samples)), centre);

  Fit fit{{start.rows, start(centre)}};
  if (options.start == AlignStart::principal_axes) fit = best_match_of_axes(coarse, radius, target, options);
  fit = refine(coarse, fit, radius, target, options.max_iterations, kCoarseTolerance);
  check_progress(options, 0.5);
  fit = refine(fine, fit, radius, target, options.max_iterations, kTolerance);
  check_progress(options, 1);

  const Correspondences before = find_correspondences(coarse, {Affine{}.rows, centre}, target);
  const Correspondences after = find_correspondences(fine, fit.pose, target);
  std::size_t used = 0;
  for (std::size_t i = 0; i < after.distances.size(); ++i)
    used += after.usable[i] && after.distances[i] <= fit.cut;
  Alignment result;
  result.samples = fine.points.size();
  result.fraction_used = static_cast<double>(used) / static_cast<double>(result.samples);
  result.before = residuals(before.distances, result.fraction_used);
  result.after = residuals(after.distances, result.fraction_used);
  result.iterations = fit.iterations;
  result.converged = fit.converged;
  result.centre = fit.pose.offset;
  result.gyration_radius = extent;
  result.freedoms = degrees_of_freedom(thinned(after, kThin), o2, {fit.pose.offset, radius}, fit.cut,
                                       result.after.trimmed_rms, used);
  const Vec3 offset = fit.pose.offset - fit.pose.linear(centre);
  result.transform = mesh::Similarity{{fit.pose.rows, offset}, 1}.transform();
  return result;
}

}  // namespace

Alignment align(const Mesh& o1, const Sites& o2, const AlignOptions& options) try {
  validate(o1);
  return align_samples(surface_source(o1), o2, options);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the alignment");
}

Alignment align(std::span<const Vec3> points, std::span<const Vec3> normals, const Sites& o2,
                const AlignOptions& options) try {
  using mesh::kMaxCoordinate;
  if (points.empty()) throw Error("an alignment needs points");
  if (!normals.empty() && normals.size() != points.size())
    throw Error("an alignment needs one normal for each point, or none");
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const double x : points[i])
      if (!(std::abs(x) <= kMaxCoordinate))
        throw Error("point " + std::to_string(i) + " has a coordinate that is NaN or beyond 1e37");
  return align_samples(cloud_source(points, normals), o2, options);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the alignment");
}

}  // namespace sdm
