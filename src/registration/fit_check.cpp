#include <sdm/doubts.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>
#include <vector>

#include "core/memory.h"
#include "mesh/similarity.h"
#include "registration/freedoms.h"
#include "registration/point_to_plane.h"
#include "registration/refine.h"

namespace sdm {
namespace {

using namespace registration;

constexpr std::size_t kFew = 256, kSome = 1024;  // samples

/// Samples of O1 as it was aligned, at most `count`, relative to their centre there.
struct Aligned {
  CentredSamples o1;
  Affine pose;
};

Aligned aligned(const SampleSource& source, std::size_t count, const Alignment& found) {
  const Affine map = mesh::Similarity::of(found.transform).map;
  Aligned result{{source(count), found.gyration_radius > 0 ? found.gyration_radius : 1}, {}};
  for (Vec3& p : result.o1.samples.points) p = map(p) - found.centre;
  for (Vec3& n : result.o1.samples.normals) n = map.linear(n);
  result.pose.offset = found.centre;
  return result;
}

void mirror(Samples& samples) {
  for (Vec3& p : samples.points) p[0] = -p[0];
  for (Vec3& n : samples.normals) n[0] = -n[0];
}

/// Every so many of the samples, which are in spatial order.
CentredSamples every(std::size_t step, const CentredSamples& o1) {
  CentredSamples part{{}, o1.radius};
  for (std::size_t i = 0; i < o1.samples.points.size(); i += step) {
    part.samples.points.push_back(o1.samples.points[i]);
    if (!o1.samples.normals.empty()) part.samples.normals.push_back(o1.samples.normals[i]);
  }
  return part;
}

/// Leaves the most promising of many poses, by few steps of a quarter of the samples.
void keep_promising(const CentredSamples& few, const Target& target, AxisMatches& candidates) {
  constexpr StepLimits kLimits{.most = 3, .tolerance = 1e-2};
  constexpr std::size_t kKept = 6, kShare = 4;
  if (candidates.poses.size() <= kKept) return;
  const CentredSamples part = every(kShare, few);
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < candidates.poses.size(); ++i)
    order.emplace_back(mismatch(part, refine(part, {candidates.poses[i]}, target, kLimits).pose, target), i);
  std::ranges::sort(order);
  std::vector<Affine> kept;
  for (std::size_t k = 0; k < kKept; ++k) kept.push_back(candidates.poses[order[k].second]);
  candidates.poses = std::move(kept);
  candidates.likely = kKept;
}

/// The misfit from where the principal axes agree, as a length; infinite if few samples are far from `most`.
double misfit_by_axes(const CentredSamples& few, const CentredSamples& some, std::span<const Vec3> o2,
                      const Target& target, double most) {
  constexpr StepLimits kLimits{.most = 10, .tolerance = 1e-3};
  constexpr int kSteps = 6;
  constexpr double kFar = 2;
  AxisMatches candidates = axis_matches(some.samples.points, o2);
  candidates.poses.resize(candidates.likely);
  keep_promising(few, target, candidates);
  const Fit fit = best_match_of_axes(few, candidates, target, kSteps, [](std::size_t) {});
  if (!(mismatch(few, fit.pose, target) <= kFar * most)) return kEverything;
  return mismatch(some, refine(some, fit, target, kLimits).pose, target);
}

std::optional<MirroredFit> mirrored_fit(const SampleSource& source, const Sites& o2, const Alignment& found) {
  constexpr double kFits = 0.002, kMuchBetter = 0.25, kFitting = 0.9, kTrimmed = 0.01;
  // Outliers of a scan are no reason to look further.
  if (found.fraction_fitting >= kFitting && found.after.trimmed_rms <= kTrimmed * found.gyration_radius)
    return std::nullopt;
  const Target target(o2);
  Aligned some = aligned(source, kSome, found);
  const double radius = some.o1.radius, as_given = mismatch(some.o1, some.pose, target);
  if (!(as_given > kFits * radius)) return std::nullopt;

  constexpr std::size_t kOfO2 = 4096;
  const std::vector<Vec3> o2_points = surface_source(o2.mesh())(kOfO2).points;
  Aligned few = aligned(source, kFew, found);
  const double most = kMuchBetter * as_given;
  const auto by_axes = [&](double enough) {
    return misfit_by_axes(few.o1, some.o1, o2_points, target, enough);
  };
  mirror(few.o1.samples);
  mirror(some.o1.samples);
  const double mirrored = by_axes(most);
  if (!(mirrored <= most)) return std::nullopt;
  // A part that is symmetric to a plane fits both ways.
  mirror(few.o1.samples);
  mirror(some.o1.samples);
  const double turned = by_axes(kEverything);
  if (turned <= kFits * radius || !(mirrored <= kMuchBetter * turned)) return std::nullopt;
  return MirroredFit{mirrored / radius, as_given / radius};
}

/// A step of the motion and the scale, which moves a sample by ε (x − c): by n·(x − c) per ε along the
/// normal.
struct ScaleStep {
  double change = 0, standard_error = 0;
  Motion motion = Motion::Zero();
};

std::optional<ScaleStep> scale_step(const Correspondences& pairs, const Pivot& pivot, const Motions& motions,
                                    double cut) {
  Matrix6 matrix = Matrix6::Zero();
  Motion mixed = Motion::Zero(), gradient = Motion::Zero();
  double scales = 0, along = 0, residuals = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < pairs.points.size(); ++i) {
    if (!has_weight(pairs, i, cut)) continue;
    const Motion j = normal_motion(pairs.points[i], pairs.normals[i], pivot);
    const double s = dot(pairs.normals[i], pairs.points[i] - pivot.centre);
    const double r = dot(pairs.normals[i], pairs.points[i] - pairs.closest[i]);
    matrix.noalias() += j * j.transpose();
    mixed += s * j;
    gradient += r * j;
    scales += s * s;
    along += s * r;
    residuals += r * r;
    ++count;
  }
  constexpr std::size_t kUnknowns = 7;
  if (count <= kUnknowns) return std::nullopt;
  // The motion is eliminated: (s·s − mᵀM⁻¹m) ε = −(s·r − mᵀM⁻¹g).
  const Motion by_scale = solved_within(matrix, motions, mixed);
  const double own = scales - mixed.dot(by_scale);
  if (!(own > kFree * kFree * pivot.radius * pivot.radius * static_cast<double>(count))) return std::nullopt;
  ScaleStep step;
  step.change = -(along - gradient.dot(by_scale)) / own;
  step.motion = -solved_within(matrix, motions, gradient) - step.change * by_scale;
  step.standard_error = std::sqrt(residuals / static_cast<double>(count - kUnknowns) / own);
  return step;
}

double capped_rms(const Correspondences& pairs, double most) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < pairs.points.size(); ++i) {
    if (!pairs.usable[i]) continue;
    const double d = std::min(pairs.distances[i], most);
    sum += d * d;
    ++count;
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
}

std::optional<OtherScale> scale_of(const SampleSource& source, const Sites& o2, const Alignment& found) {
  constexpr double kRounding = 1e-6, kLeastErrors = 5, kLeft = 0.5, kMost = 1.2, kTolerance = 1e-7;
  constexpr int kSteps = 5;
  if (std::ranges::any_of(found.freedoms, &DegreeOfFreedom::locked)) return std::nullopt;
  if (!(found.after.rms > kRounding * found.gyration_radius)) return std::nullopt;
  const Target target(o2);
  Aligned now = aligned(source, kSome, found);
  const Samples samples = now.o1.samples;
  OtherScale result;
  double cut = 0;
  for (int step = 0;; ++step) {
    const Correspondences pairs = find_correspondences(now.o1.samples, now.pose, target);
    const Pivot pivot{now.pose.offset, now.o1.radius};
    const Motions motions = determined_motions(pairs, o2, pivot, kEverything, Motions(Matrix6::Identity()));
    if (step == 0) cut = trimming_cut(pairs, pivot, motions);
    (step == 0 ? result.residual_as_given : result.residual) = capped_rms(pairs, cut);
    const auto next =
        scale_step(pairs, pivot, motions, step == 0 ? cut : trimming_cut(pairs, pivot, motions));
    if (!next) return std::nullopt;
    result.standard_error = result.factor * next->standard_error;
    if (step == kSteps || (step > 0 && std::abs(next->change) < kTolerance)) break;
    if (step == 0 && !(std::abs(next->change) > next->standard_error)) return std::nullopt;
    result.factor *= 1 + next->change;
    if (!(result.factor > 1 / kMost && result.factor < kMost)) return std::nullopt;
    now.pose = moved(now.pose, pivot, next->motion);
    now.o1.samples = samples;
    for (Vec3& p : now.o1.samples.points) p = result.factor * p;
  }
  const double left = result.residual * result.residual;
  const double before = result.residual_as_given * result.residual_as_given;
  const bool significant =
      std::abs(result.factor - 1) > kLeastErrors * result.standard_error && left <= kLeft * before;
  return significant ? std::optional(result) : std::nullopt;
}

template <class Check>
auto checked(Check&& check) try {
  return check();
} catch (const std::bad_alloc&) {
  throw out_of_memory("the check of the alignment");
}

}  // namespace

std::optional<MirroredFit> find_mirrored(const Mesh& o1, const Sites& o2, const Alignment& found) {
  validate(o1);
  return checked([&] { return mirrored_fit(surface_source(o1), o2, found); });
}

std::optional<MirroredFit> find_mirrored(std::span<const Vec3> points, std::span<const Vec3> normals,
                                         const Sites& o2, const Alignment& found) {
  return checked([&] { return mirrored_fit(cloud_source(points, normals), o2, found); });
}

std::optional<OtherScale> find_scale(const Mesh& o1, const Sites& o2, const Alignment& found) {
  validate(o1);
  return checked([&] { return scale_of(surface_source(o1), o2, found); });
}

std::optional<OtherScale> find_scale(std::span<const Vec3> points, std::span<const Vec3> normals,
                                     const Sites& o2, const Alignment& found) {
  return checked([&] { return scale_of(cloud_source(points, normals), o2, found); });
}

}  // namespace sdm
