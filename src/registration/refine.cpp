#include "registration/refine.h"

#include <sdm/error.h>

#include <algorithm>

#include "registration/freedoms.h"
#include "registration/point_to_plane.h"

namespace sdm::registration {

Fit refine(const CentredSamples& o1, Fit fit, const Target& target, const StepLimits& limits,
           LockedMotion* locked) {
  const Pivot pivot{fit.pose.offset, o1.radius};
  fit.converged = false;
  Motions motions;
  for (int step = 0; step < limits.most && !fit.converged; ++step, ++fit.iterations) {
    const Correspondences pairs = find_correspondences(o1.samples, fit.pose, target);
    if (target.region && std::ranges::count(pairs.usable, 1) == 0)
      throw Error("no part of O1 is near the region of O2 that it is to be aligned to");
    if (step == 0 || locked) {  // what is allowed turns along
      const Motions allowed = locked ? locked->allowed(pivot) : Motions(Matrix6::Identity());
      motions = determined_motions(thinned(pairs, kThin), target.sites, pivot, kEverything, allowed);
    }
    fit.cut = trimming_cut(pairs, pivot, motions);
    const Motion motion = best_motion(pairs, pivot, motions, fit.cut);
    if (locked) {
      locked->move(motion, pivot);
      fit.pose = locked->pose();
    } else {
      fit.pose = moved(fit.pose, pivot, motion);
    }
    fit.converged = motion.norm() < limits.tolerance * o1.radius;
  }
  return fit;
}

double mismatch(const CentredSamples& o1, const Affine& pose, const Target& target) {
  constexpr double kMost = 0.1;
  double sum = 0;
  for (const double d : find_correspondences(o1.samples, pose, target).distances)
    sum += std::min(d, kMost * o1.radius);
  return sum / static_cast<double>(o1.samples.points.size());
}

}  // namespace sdm::registration
