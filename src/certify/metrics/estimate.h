// The distances of all points of A, estimated from random ones.
#pragma once

#include <sdm/metrics.h>

#include <vector>

#include "certify/metrics/surface_points.h"
#include "sites/sites_data.h"

namespace sdm::metrics {

/// Each number with an interval in which it is with a probability of at least MetricsOptions::kConfidence,
/// also after it was combined with the same number of the other direction: each end misses with a quarter of
/// the rest. The largest distance is certified.
class DirectedEstimate {
 public:
  /// The arguments must outlive this object. `stream`: of the random numbers, different for both directions.
  DirectedEstimate(const Mesh& a, const sites::SitesData& b, const MetricsOptions& options,
                   const Scale& scale, std::uint64_t stream);

  /// Throws Cancelled.
  [[nodiscard]] DirectedMetrics run();

 private:
  struct Sample {
    std::vector<double> distances;  ///< of points in any order
    double consistency = 0;         ///< the mean of |n(p)·n(q)|
  };
  /// The mean of a power of the distances.
  struct Mean {
    double value = 0, lower = 0, upper = 0;
    double enough = 0;  ///< the number of points at which the ends are as close as is asked
  };

  /// A bound on all distances, not closer than `enough`.
  [[nodiscard]] double bound_largest(double enough) const;
  [[nodiscard]] Sample measure(std::size_t count, std::uint64_t stream) const;
  [[nodiscard]] DirectedMetrics evaluate(Sample sample);
  [[nodiscard]] Mean mean(const std::vector<double>& distances, int power) const;
  [[nodiscard]] BoundedNumber percentile(std::vector<double>& distances, double percent) const;
  [[nodiscard]] BoundedNumber within(const std::vector<double>& distances, double tolerance) const;
  /// How far the ends of the interval of a distance may be from its value.
  [[nodiscard]] double asked(double value) const;
  void ask_for(double points);

  const Mesh& a_;
  const sites::SitesData& b_;
  const MetricsOptions& options_;
  const Scale scale_;
  const SurfacePoints points_;
  const std::uint64_t stream_;
  double largest_ = 0;  // bound on all distances
  double usual_ = 0;    // few distances are larger
  double enough_ = 0;   // the most points that a number has asked for
};

}  // namespace sdm::metrics
