#include <sdm/align.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "core/memory.h"
#include "mesh/similarity.h"
#include "mesh/validate.h"
#include "registration/correspondences.h"
#include "registration/freedoms.h"
#include "registration/locked_motion.h"
#include "registration/point_to_plane.h"
#include "registration/principal_axes.h"
#include "registration/refine.h"
#include "registration/samples.h"

namespace sdm {
namespace {

using namespace registration;

constexpr std::size_t kCoarse = 1024;  // samples of the first level

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

template <class Progress>
Fit from_principal_axes(const CentredSamples& o1, const Target& target, Progress&& progress) {
  constexpr std::size_t kSamples = 4096;
  constexpr int kSteps = 15;
  const AxisMatches candidates =
      axis_matches(o1.samples.points, surface_source(target.sites.mesh())(kSamples).points);
  return best_match_of_axes(o1, candidates, target, kSteps, [&](std::size_t i) {
    progress(static_cast<double>(i) / static_cast<double>(candidates.poses.size()));
  });
}

/// Whether samples are farther from O2 than noise explains: of a part that is placed right, few are much
/// farther than the half of them.
bool is_poor(const CentredSamples& o1, const Affine& pose, const Target& target) {
  constexpr double kPoor = 0.01, kGood = 1e-4;  // of the radius
  constexpr double kUneven = 2;                 // times the median; 1.2 for Gaussian noise
  const double found = mismatch(o1, pose, target);
  if (found > kPoor * o1.radius) return true;
  if (found <= kGood * o1.radius) return false;
  std::vector<double> distances = find_correspondences(o1.samples, pose, target).distances;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::ranges::nth_element(distances, middle);
  return found > kUneven * *middle;
}

/// The fit from the principal axes, if it is clearly better than a pose.
std::optional<Fit> better_by_axes(const CentredSamples& o1, const Affine& pose, const Target& target,
                                  const AlignOptions& options) {
  constexpr double kBetter = 0.7;
  const Fit fit = from_principal_axes(o1, target, [&](double) { check_progress(options, 0.5); });
  return mismatch(o1, fit.pose, target) < kBetter * mismatch(o1, pose, target) ? std::optional(fit)
                                                                               : std::nullopt;
}

AlignResiduals residuals(const Correspondences& pairs, double fraction_used) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < pairs.points.size(); ++i)
    if (pairs.is_selected(i)) distances.push_back(pairs.distances[i]);
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
  if (distances.empty()) result.trimmed_rms = result.rms;
  return result;
}

std::vector<GroupResiduals> group_residuals(const Correspondences& pairs,
                                            std::span<const std::uint32_t> group_of_face) {
  std::vector<GroupResiduals> groups;
  for (const std::uint32_t group : group_of_face)
    if (group != kNone && group >= groups.size()) groups.resize(group + std::size_t{1});
  if (groups.empty()) return groups;
  for (std::size_t i = 0; i < pairs.points.size(); ++i) {
    const std::uint32_t number = group_of_face[pairs.faces[i]];
    if (number == kNone) continue;
    GroupResiduals& group = groups[number];
    const double d = pairs.distances[i];
    ++group.samples;
    group.rms += d * d;
    group.largest = std::max(group.largest, d);
  }
  for (GroupResiduals& group : groups)
    if (group.samples > 0) group.rms = std::sqrt(group.rms / static_cast<double>(group.samples));
  return groups;
}

void check(const AlignOptions& options, const Mesh& o2) {
  check_options(options);
  check_options(options.freedoms);
  if (options.start == AlignStart::principal_axes && !options.freedoms.all())
    throw Error("an alignment with locked freedoms starts at a pose, not at the principal axes");
  const std::size_t faces = o2.triangles.size();
  if (!options.region.faces.empty() && options.region.faces.size() != faces)
    throw Error("the region of the alignment needs an entry for each face of O2");
  if (!options.group_of_face.empty() && options.group_of_face.size() != faces)
    throw Error("the groups of the alignment need an entry for each face of O2");
  for (const std::uint32_t group : options.group_of_face)
    if (group != kNone && group >= faces) throw Error("the number of a group is not below that of the faces");
  for (const Box& box : options.region.boxes)
    for (int k = 0; k < 3; ++k)
      if (!(box.lower[k] <= box.upper[k])) throw Error("a box of the region of the alignment is empty");
}

Samples relative(Samples samples, const Vec3& centre) {
  for (Vec3& p : samples.points) p = p - centre;
  return samples;
}

/// Whether O1 is closer to O2 at `before` than at `after`: by as many of its samples as have a weight there.
bool is_closer(const Correspondences& before, const Correspondences& after, double cut) {
  std::size_t used = 0, all = 0;
  for (std::size_t i = 0; i < after.points.size(); ++i)
    if (after.is_selected(i)) {
      ++all;
      used += has_weight(after, i, cut);
    }
  if (used == 0) return false;
  const double fraction = static_cast<double>(used) / static_cast<double>(all);
  return residuals(before, fraction).trimmed_rms < residuals(after, fraction).trimmed_rms;
}

/// Whether steps from a pose led to larger residuals.
bool leads_away(const CentredSamples& o1, const Affine& begin, const Fit& fit, const Target& target) {
  return is_closer(find_correspondences(o1.samples, begin, target),
                   find_correspondences(o1.samples, fit.pose, target), fit.cut);
}

/// A pose that was not reached by steps, with the samples that have a weight there.
Fit fit_at(const Affine& pose, const Fit& steps, const CentredSamples& o1, const Target& target,
           const LockedMotion* locked) {
  const Pivot pivot{pose.offset, o1.radius};
  const Correspondences pairs = find_correspondences(o1.samples, pose, target);
  const Motions allowed = locked ? locked->allowed(pivot) : Motions(Matrix6::Identity());
  const Motions motions =
      determined_motions(thinned(pairs, kThin), target.sites, pivot, kEverything, allowed);
  return {pose, trimming_cut(pairs, pivot, motions), steps.iterations, steps.converged};
}

/// The shares of the samples in the region that have a weight, and that fit.
void add_fractions(const Correspondences& pairs, double cut, double radius, Alignment& result) {
  constexpr double kRounding = 1e-5;  // of single precision, and of text with six digits, of coordinates
  std::size_t used = 0, fitting = 0;
  result.samples = 0;
  for (std::size_t i = 0; i < pairs.distances.size(); ++i) {
    if (!pairs.is_selected(i)) continue;
    const bool has = has_weight(pairs, i, cut);
    ++result.samples;
    used += has;
    fitting += has || pairs.distances[i] <= kRounding * radius;
  }
  if (result.samples == 0) throw Error("no part of O1 is near the region of O2 that it was aligned to");
  const auto all = static_cast<double>(result.samples);
  result.fraction_used = static_cast<double>(used) / all;
  result.fraction_fitting = static_cast<double>(fitting) / all;
}

Alignment align_samples(const SampleSource& source, const Sites& o2, const AlignOptions& options) {
  constexpr double kCoarseTolerance = 1e-4, kTolerance = 1e-6;
  check(options, o2.mesh());
  const Affine start = rigid(options.pose);
  check_progress(options, 0);

  Target target(o2);
  const Samples given = source(options.samples);
  const auto [centre, extent] = robust_extent(given.points);
  const double radius = extent > 0 ? extent : 1;
  const CentredSamples fine{relative(given, centre), radius};
  const CentredSamples coarse{relative(source(std::min(kCoarse, options.samples)), centre), radius};

  const Affine begin{start.rows, start(centre)};
  Fit fit{begin};
  std::optional<LockedMotion> motion;
  if (!options.freedoms.all()) motion.emplace(options.freedoms, fit.pose);
  LockedMotion* locked = motion ? &*motion : nullptr;
  if (options.start == AlignStart::principal_axes)
    fit = from_principal_axes(coarse, target, [&](double done) { check_progress(options, done / 2); });
  fit = refine(coarse, fit, target, {options.max_iterations, kCoarseTolerance}, locked);
  check_progress(options, 0.5);
  const bool may_keep = options.start != AlignStart::principal_axes;
  // Steps that lead away from O2 without an end, as of a part that is far too large, go on for long.
  bool kept = may_keep && !fit.converged && leads_away(coarse, begin, fit, target);
  if (const Affine& found = kept ? begin : fit.pose;
      options.start == AlignStart::automatic && !locked && is_poor(coarse, found, target))
    if (const std::optional<Fit> better = better_by_axes(coarse, found, target, options)) {
      const int before = fit.iterations;
      fit = refine(coarse, *better, target, {options.max_iterations, kCoarseTolerance});
      fit.iterations += before;
      kept = false;
    }
  if (!options.region.whole()) target.region = &options.region;
  if (!kept) {
    fit = refine(fine, fit, target, {options.max_iterations, kTolerance}, locked);
    kept = may_keep && leads_away(coarse, begin, fit, target) && leads_away(fine, begin, fit, target);
  }
  if (kept) {
    if (locked) motion.emplace(options.freedoms, begin);
    fit = fit_at(begin, fit, fine, target, locked);
  }
  check_progress(options, 1);

  const Correspondences before = find_correspondences(coarse.samples, {Affine{}.rows, centre}, target);
  const Correspondences after = find_correspondences(fine.samples, fit.pose, target);
  Alignment result;
  add_fractions(after, fit.cut, radius, result);
  result.before = residuals(before, result.fraction_used);
  result.after = residuals(after, result.fraction_used);
  result.iterations = fit.iterations;
  result.converged = fit.converged;
  result.centre = fit.pose.offset;
  result.gyration_radius = extent;
  const Pivot pivot{fit.pose.offset, radius};
  const auto used =
      static_cast<std::size_t>(std::round(result.fraction_used * static_cast<double>(result.samples)));
  result.freedoms = degrees_of_freedom(thinned(after, kThin), o2, pivot, fit.cut, result.after.trimmed_rms,
                                       used, locked ? locked->allowed(pivot) : Motions(Matrix6::Identity()));
  result.groups = group_residuals(after, options.group_of_face);
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

AlignMotion motion_of(const Alignment& alignment) {
  const auto& r = alignment.transform.rows;
  // The antisymmetric part is accurate for small angles, unlike the trace alone.
  const double sine = 0.5 * std::hypot(r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]);
  const double angle = std::atan2(sine, 0.5 * (r[0][0] + r[1][1] + r[2][2] - 1));
  const Vec3& centre = alignment.centre;
  Vec3 before{};  // the inverse of a rotation is its transpose
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) before[i] += r[j][i] * (centre[j] - r[j][3]);
  return {angle * 180 / std::numbers::pi,
          std::hypot(centre[0] - before[0], centre[1] - before[1], centre[2] - before[2])};
}

}  // namespace sdm
