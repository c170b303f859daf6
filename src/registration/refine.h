// The steps of an alignment: from a start to the nearest optimum.
#pragma once

#include "geometry/affine.h"
#include "registration/correspondences.h"
#include "registration/locked_motion.h"
#include "registration/principal_axes.h"
#include "registration/samples.h"

namespace sdm::registration {

inline constexpr double kEverything = kInfinity;
inline constexpr std::size_t kThin = 4096;  // samples that show which motions are determined

/// The state of a registration: a pose of samples that are relative to their centre.
struct Fit {
  Affine pose;
  double cut = kEverything;
  int iterations = 0;
  bool converged = false;
};

/// Samples relative to a centre, and their radius of gyration; 1 if they are in one place.
struct CentredSamples {
  Samples samples;
  double radius = 1;
};

/// When steps end.
struct StepLimits {
  int most = 100;
  double tolerance = 1e-6;  ///< of the length of a step, relative to the radius
};

/// Steps until one is short. `locked`: what may be moved, which moves along; null: everything. Throws
/// sdm::Error if no sample is near the region of the target.
[[nodiscard]] Fit refine(const CentredSamples& o1, Fit fit, const Target& target, const StepLimits& limits,
                         LockedMotion* locked = nullptr);

/// The mean distance, of which each counts at most a tenth of the radius: small features decide between poses
/// of a nearly symmetric part, and outliers do not.
[[nodiscard]] double mismatch(const CentredSamples& o1, const Affine& pose, const Target& target);

/// Refines poses by at most so many steps, and returns the one with the least mismatch: of the likely ones,
/// or of all if none of these is good. `progress` is called with the number of each pose, before it is
/// refined.
template <class Progress>
[[nodiscard]] Fit best_match_of_axes(const CentredSamples& o1, const AxisMatches& candidates,
                                     const Target& target, int steps, Progress&& progress) {
  const StepLimits limits{.most = steps, .tolerance = 1e-3};
  constexpr double kGood = 0.01;
  double least = kEverything;
  Fit best;
  for (std::size_t i = 0; i < candidates.poses.size(); ++i) {
    if (i >= candidates.likely && least < kGood * o1.radius) break;
    progress(i);
    const Fit fit = refine(o1, {candidates.poses[i]}, target, limits);
    if (const double found = mismatch(o1, fit.pose, target); found < least) {
      least = found;
      best = fit;
    }
  }
  return best;
}

}  // namespace sdm::registration
