// The distances of all points of A, bounded as closely as is asked.
#pragma once

#include <sdm/metrics.h>

#include <vector>

#include "certify/metrics/part.h"

namespace sdm::metrics {

/// Lengths of both meshes together.
struct Scale {
  double size = 0;      ///< the diagonal of their box
  double rounding = 0;  ///< of distances and coordinates, in double precision
  double accuracy = 0;  ///< of the cpu engine
};

/// A surface A divided into parts, until the sums over them are as close as the options ask.
class DirectedSearch {
 public:
  /// All must outlive this object.
  DirectedSearch(const Mesh& a, const sites::SitesData& b, const MetricsOptions& options, const Scale& scale);

  /// Throws sdm::Error if the faces have no area; Cancelled.
  [[nodiscard]] DirectedMetrics run();

 private:
  /// Whether each part should be bounded more closely.
  using Chosen = std::vector<std::uint8_t>;

  void make_parts();
  void sum_up();
  /// The largest distance that counts as within a tolerance.
  [[nodiscard]] double limit(double tolerance) const;
  /// The fraction of the area that is within a tolerance.
  [[nodiscard]] BoundedNumber within(double tolerance) const;
  [[nodiscard]] BoundedNumber percentile(double percent) const;
  /// The least t such that `bound` is at most t on this fraction of the area.
  [[nodiscard]] double quantile(double fraction, Linear (Part::*bound)() const) const;
  [[nodiscard]] double width(const BoundedNumber& number) const;
  [[nodiscard]] Chosen choose() const;
  void choose_by_share(const std::vector<double>& contributions, double target, Chosen& chosen) const;
  void choose_around(const BoundedNumber& percentile, Chosen& chosen) const;
  /// Returns whether a bound may have changed.
  bool refine(const Chosen& chosen);
  void divide(const std::vector<std::size_t>& divided);
  /// Bounds parts, given by their numbers, by the distances of their middles.
  void bound_by_middles(const std::vector<std::size_t>& numbers);

  const Mesh& a_;
  const sites::SitesData& b_;
  const MetricsOptions& options_;
  const Scale scale_;
  std::vector<Part> parts_;
  std::size_t most_parts_ = 0;
  double rounding_ = 0;  // of areas and their sums, as a fraction of the whole area
  double largest_ = 0;   // bound on all distances
  DirectedMetrics sums_;
};

}  // namespace sdm::metrics
