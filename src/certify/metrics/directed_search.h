// The distances of all points of A, bounded as closely as is asked.
#pragma once

#include <sdm/metrics.h>

#include <functional>
#include <vector>

#include "certify/metrics/part.h"
#include "certify/metrics/surface_points.h"
#include "core/numbers/compensated_sum.h"

namespace sdm::metrics {

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
  enum class Refined : std::uint8_t { no, yes, too_many };

  struct Means {
    CompensatedSum low, high, square_low, square_high;
    double largest = 0;  ///< bound on all distances
  };
  struct Within {
    CompensatedSum low, high;
    bool all = true, any = false;
  };
  /// The area with distances up to equal steps between the bounds of a percentile, by the lower and the upper
  /// bounds of the parts: what each step adds to the one before.
  struct Steps {
    BoundedNumber bounds;
    std::vector<CompensatedSum> below_low, below_high;

    explicit Steps(const BoundedNumber& found);
    [[nodiscard]] double at(std::size_t i) const;
    void add(const FacePart& part);
  };
  /// Sums over parts that are no longer in memory.
  struct Settled {
    Means means;
    std::vector<Within> within;      ///< of each tolerance
    std::vector<Steps> percentiles;  ///< of each
    double consistency = 0;
  };

  void make_parts();
  void refine_in_runs();
  /// Adds the parts to what is settled.
  void settle();
  void sum_up();
  static void add_means(const std::vector<FacePart>& parts, Means& means);
  static void add_within(const std::vector<FacePart>& parts, double limit, Within& sum);
  [[nodiscard]] double consistency() const;
  /// The largest distance that counts as within a tolerance.
  [[nodiscard]] double limit(double tolerance) const;
  /// The fraction of the area that is within a tolerance, by its number.
  [[nodiscard]] BoundedNumber within(std::size_t tolerance) const;
  [[nodiscard]] BoundedNumber percentile(std::size_t number) const;
  [[nodiscard]] BoundedNumber percentile(const Steps& steps, double least, double most) const;
  /// The least t such that `bound` is at most t on this fraction of the area, or the end of what is known of
  /// it if it is beyond.
  [[nodiscard]] double quantile(double fraction, TwoSided (FacePart::*bound)() const,
                                const BoundedNumber& known) const;
  [[nodiscard]] double width(const BoundedNumber& number) const;
  [[nodiscard]] Chosen choose() const;
  void choose_by_share(const std::vector<double>& contributions, double target, Chosen& chosen) const;
  void choose_around(const BoundedNumber& percentile, Chosen& chosen) const;
  /// Calls visit(i) for all parts, on all cores.
  void for_each_part(const std::function<void(std::size_t)>& visit) const;
  [[nodiscard]] static bool can_be_thorough(const FacePart& part);
  [[nodiscard]] bool can_be_closer(const FacePart& part) const;
  /// Returns whether a bound may have changed; `too_many`: there are `most` parts already.
  Refined refine(const Chosen& chosen, std::size_t most);
  void divide(const std::vector<std::size_t>& divided);
  /// Bounds parts, given by their numbers, by the distances of their middles.
  void bound_by_middles(const std::vector<std::size_t>& numbers);

  const Mesh& a_;
  const sites::SitesData& b_;
  const MetricsOptions& options_;
  const Scale scale_;
  std::vector<FacePart> parts_;
  std::size_t most_parts_ = 0;
  double rounding_ = 0;   // of areas and their sums, as a fraction of the whole area
  double area_ = 0;       // of the parts in memory
  bool in_runs_ = false;  // whether they are a run of all
  Settled settled_;
  DirectedMetrics sums_;
  std::vector<BoundedNumber> known_percentiles_;  // before the present sums
  double largest_ = 0;                            // bound on all distances
};

}  // namespace sdm::metrics
