#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/hausdorff.h>
#include <sdm/metrics.h>
#include <sdm/sites.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include "certify/metrics/directed_search.h"
#include "certify/metrics/estimate.h"
#include "certify/metrics/surface_points.h"
#include "core/memory.h"
#include "core/numbers/compensated_sum.h"
#include "geometry/rounding.h"
#include "geometry/triangle.h"
#include "geometry/vec.h"

namespace sdm {
namespace {

/// One progress of a computation of several stages, each of a number of steps that is not known in advance.
/// Reports "metrics" with a fraction that never decreases. Each step of a stage, which begins where the
/// fraction of the step before falls or its name changes, takes half of what is left of its stage.
class StagedProgress {
 public:
  explicit StagedProgress(Progress progress) : progress_(std::move(progress)) {}
  StagedProgress(const StagedProgress&) = delete;
  StagedProgress& operator=(const StagedProgress&) = delete;

  /// Begins the stage that ends with this fraction of the whole, and returns its progress, which refers to
  /// this object; empty without a progress.
  [[nodiscard]] Progress stage(double end) {
    begin_ = end_;
    end_ = end;
    last_ = 0;
    step_.clear();
    if (!progress_) return {};
    return [this](std::string_view step, double fraction) { return report(step, fraction); };
  }

  void finish() const {
    if (progress_ && !progress_("metrics", 1)) throw Cancelled();
  }

 private:
  bool report(std::string_view step, double fraction) {
    if (step_ != step || fraction < last_) {
      begin_ += share() * last_;
      step_ = step;
    }
    last_ = std::clamp(fraction, 0.0, 1.0);
    return progress_("metrics", begin_ + share() * last_);
  }
  [[nodiscard]] double share() const { return (end_ - begin_) / 2; }

  Progress progress_;
  double begin_ = 0, end_ = 0;  ///< what is left of the stage
  double last_ = 0;             ///< fraction of the present step
  std::string step_;
};

// The search for the largest distances takes about this share of the whole progress.
constexpr double kOfHausdorff = 0.2;

BoundedNumber exactly(double value) {
  return {.value = value, .certainty = Certainty::exact, .lower = value, .upper = value};
}

/// An increasing function of two numbers.
template <class Function>
BoundedNumber combined(const BoundedNumber& a, const BoundedNumber& b, const Function& f) {
  BoundedNumber result{.lower = (1 - kFewRoundings) * f(a.lower, b.lower),
                       .upper = (1 + kFewRoundings) * f(a.upper, b.upper)};
  result.value = std::clamp(f(a.value, b.value), result.lower, result.upper);
  result.certainty = std::max(a.certainty, b.certainty);
  return result;
}

/// combined() by a function whose value lies between those of its arguments, also after rounding.
template <class Function>
BoundedNumber averaged(const BoundedNumber& a, const BoundedNumber& b, const Function& f) {
  BoundedNumber result = combined(a, b, f);
  result.lower = std::max(result.lower, std::min(a.lower, b.lower));
  result.upper = std::min(result.upper, std::max(a.upper, b.upper));
  result.value = std::clamp(result.value, result.lower, result.upper);
  return result;
}

BoundedNumber larger(const BoundedNumber& a, const BoundedNumber& b) {
  BoundedNumber result = a.lower < b.lower || (a.lower == b.lower && a.upper < b.upper) ? b : a;
  if (const double upper = std::max(a.upper, b.upper); upper > result.upper) {
    result.upper = upper;
    result.certainty = Certainty::bounded;
  }
  if (std::max(a.certainty, b.certainty) == Certainty::estimate) result.certainty = Certainty::estimate;
  result.value = std::max(a.value, b.value);
  return result;
}

double sum(double x, double y) {
  return x + y;
}

double mean(double x, double y) {
  return x / 2 + y / 2;
}

double sum_of_squares(double x, double y) {
  return x * x + y * y;
}

double harmonic_mean(double x, double y) {
  return x + y > 0 ? 2 * x * y / (x + y) : 0;
}

std::string shortest(double number) {
  number += 0.0;  // no minus sign of 0
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

double area_of(const Mesh& mesh) {
  CompensatedSum area;
  for (const Triangle& t : mesh.triangles) {
    if (is_removed(t)) continue;
    area += metrics::area_of(corners_of(mesh.positions, t)).area;
  }
  return area.value();
}

/// The measures of surfaces of which one or both are empty.
DirectedMetrics metrics_of_none(bool both, const MetricsOptions& options) {
  const BoundedNumber distance = exactly(both ? 0 : kInfinity), fraction = exactly(both ? 1 : 0);
  return {.hausdorff = distance,
          .mean = distance,
          .rms = distance,
          .percentiles = std::vector<BoundedNumber>(options.percentiles.size(), distance),
          .within = std::vector<BoundedNumber>(options.tolerances.size(), fraction),
          .normal_consistency = fraction.value};
}

/// No distance of a point exceeds the largest one.
void limit_by_largest(const MetricsOptions& options, const metrics::Scale& scale, DirectedMetrics& m) {
  const double most = m.hausdorff.upper;
  const auto limit = [&](BoundedNumber& number) {
    number.upper = std::min(number.upper, most);
    number.lower = std::min(number.lower, most);
    number.value = std::clamp(number.value, number.lower, number.upper);
    if (number.upper - number.lower <= 2 * scale.rounding) number.certainty = Certainty::exact;
  };
  limit(m.mean);
  limit(m.rms);
  for (BoundedNumber& percentile : m.percentiles) limit(percentile);
  for (std::size_t i = 0; i < m.within.size(); ++i) {
    if (most <= options.tolerances[i] + scale.accuracy) m.within[i] = exactly(1);
    if (m.within[i].lower == m.within[i].upper) m.within[i].certainty = Certainty::exact;
  }
}

std::array<DirectedMetrics, 2> both_directions(const Mesh& a, const Mesh& b, MetricsOptions options) {
  StagedProgress progress(std::move(options.progress));
  options.progress = progress.stage(kOfHausdorff);
  const std::array sites{Sites(a), Sites(b)};
  Box box = bounds(a);
  extend(box, bounds(b));
  double coordinate = 0;
  for (int k = 0; k < 3; ++k)
    coordinate = std::max({coordinate, std::abs(box.lower[k]), std::abs(box.upper[k])});
  const double size = diagonal(box);
  const metrics::Scale scale{size, kDoubleRounding * std::max(size, coordinate),
                             MetricsOptions::kRounding * size};
  if (options.estimate) {
    std::array<DirectedMetrics, 2> from;
    for (int i = 0; i < 2; ++i) {
      options.progress = progress.stage(i == 0 ? 0.5 : 1);
      from[i] = metrics::DirectedEstimate(sites[i].mesh(), internals(sites[1 - i]), options, scale, i).run();
    }
    progress.finish();
    return from;
  }
  const double precision =
      std::min(HausdorffOptions::kPrecision * size, options.precision.value_or(kInfinity));
  const SymmetricHausdorff hausdorff =
      symmetric_hausdorff(sites[0], sites[1], {.precision = precision, .progress = options.progress});
  std::array<DirectedMetrics, 2> from;
  for (int i = 0; i < 2; ++i) {
    options.progress = progress.stage(kOfHausdorff + (1 + i) * (1 - kOfHausdorff) / 2);
    from[i] = metrics::DirectedSearch(sites[i].mesh(), internals(sites[1 - i]), options, scale).run();
    from[i].hausdorff = hausdorff.from[i].distance;
    limit_by_largest(options, scale, from[i]);
  }
  progress.finish();
  return from;
}

SurfaceMetrics metrics_of(std::array<DirectedMetrics, 2> from) {
  const auto& [a, b] = from;
  const auto weighted = [&](double x, double y) {
    return x == y ? x : (a.area * x + b.area * y) / (a.area + b.area);
  };
  SurfaceMetrics result{
      .hausdorff = larger(a.hausdorff, b.hausdorff),
      .assd = averaged(a.mean, b.mean, weighted),
      .masd = averaged(a.mean, b.mean, mean),
      .rmsd = averaged(a.rms, b.rms, [&](double x, double y) { return std::sqrt(weighted(x * x, y * y)); }),
      .chamfer_l1 = combined(a.mean, b.mean, sum),
      .chamfer_l2 = combined(a.rms, b.rms, sum_of_squares),
      .normal_consistency = mean(a.normal_consistency, b.normal_consistency)};
  for (std::size_t i = 0; i < a.percentiles.size(); ++i)
    result.percentiles.push_back(larger(a.percentiles[i], b.percentiles[i]));
  for (std::size_t i = 0; i < a.within.size(); ++i) {
    result.surface_dice.push_back(averaged(a.within[i], b.within[i], weighted));
    result.f_score.push_back(averaged(a.within[i], b.within[i], harmonic_mean));
  }
  result.from = std::move(from);
  return result;
}

}  // namespace

SurfaceMetrics surface_metrics(const Mesh& a, const Mesh& b, const MetricsOptions& options) try {
  check_options(options);
  if (a.triangles.empty() || b.triangles.empty()) {
    std::array<DirectedMetrics, 2> from;
    from.fill(metrics_of_none(a.triangles.empty() && b.triangles.empty(), options));
    for (const auto& [mesh, m] : {std::pair(&a, &from[0]), std::pair(&b, &from[1])})
      if (!mesh->triangles.empty()) {
        validate(*mesh);
        m->area = area_of(*mesh);
      }
    return metrics_of(from);
  }
  SurfaceMetrics result = metrics_of(both_directions(a, b, options));
  if (options.estimate) result.confidence = MetricsOptions::kConfidence;
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the metrics");
}

std::string percentile_name(double percent) {
  return "hd" + shortest(percent);
}

std::string metric_name(std::string_view kind, double tolerance) {
  return std::string(kind) + "(" + shortest(tolerance) + ")";
}

std::vector<NamedMetric> named_metrics(const SurfaceMetrics& metrics, const MetricsOptions& options) {
  std::vector<NamedMetric> result{{"hd", metrics.hausdorff}};
  for (std::size_t i = 0; i < options.percentiles.size(); ++i)
    result.push_back({percentile_name(options.percentiles[i]), metrics.percentiles[i]});
  result.push_back({"assd", metrics.assd});
  result.push_back({"masd", metrics.masd});
  result.push_back({"rmsd", metrics.rmsd});
  result.push_back({"chamfer_l1", metrics.chamfer_l1});
  result.push_back({"chamfer_l2", metrics.chamfer_l2, MetricUnit::area});
  for (std::size_t i = 0; i < options.tolerances.size(); ++i) {
    const auto add = [&](std::string_view name, const BoundedNumber& number) {
      result.push_back({metric_name(name, options.tolerances[i]), number, MetricUnit::fraction});
    };
    add("nsd", metrics.surface_dice[i]);
    add("precision", metrics.from[0].within[i]);
    add("recall", metrics.from[1].within[i]);
    add("f_score", metrics.f_score[i]);
  }
  for (NamedMetric& m : result)
    if (m.number.certainty == Certainty::estimate) m.confidence = metrics.confidence;
  const double normals = metrics.normal_consistency;
  result.push_back({"normal_consistency",
                    {.value = normals, .certainty = Certainty::estimate, .lower = normals, .upper = normals},
                    MetricUnit::fraction});
  return result;
}

}  // namespace sdm
