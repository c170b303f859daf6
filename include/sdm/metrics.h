/// Measures that compare two surfaces by the distances of all their points: averages, percentiles, fractions
/// within tolerances, with certified bounds, or estimated.
///
/// Threads: the functions may be called concurrently.
#pragma once

#include <sdm/bounds.h>
#include <sdm/execution.h>
#include <sdm/mesh.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace sdm {

/// Options of surface_metrics().
struct MetricsOptions {
  std::vector<double> percentiles{95};  ///< in per cent, above 0 and below 100
  std::vector<double> tolerances{};     ///< distances ≥ 0, in units of the meshes
  /// Bounds of average distances and percentiles are at most this far apart; > 0, in units of the meshes. By
  /// default kRelative of their value or, where surfaces are so close that this is less than kNear of the
  /// diagonal of the box of both, that, but no more than kOfNear of the value. kLeast of the diagonal at
  /// least. Also that of the Hausdorff distance, for which HausdorffOptions::kPrecision of the diagonal is
  /// used if that is less, and no least one. Of chamfer_l2, which is of squares, the share of the value is
  /// twice that, and of f_score the width up to twice that of fractions.
  std::optional<double> precision{};
  double fraction_precision = 1e-3;  ///< of fractions of the area; > 0
  /// Parts that a surface is divided into, at most, beside its faces: then the bounds stay farther apart.
  /// In memory at once are 65,536, or 32 for each face of the finer mesh up to a million, or twice as many as
  /// faces.
  std::size_t most_parts = 4'000'000;
  /// Whether the measures are estimated from random points, in seconds, in place of bounds that hold.
  bool estimate = false;
  /// Random points of each surface, at most, and 256 at least: then the intervals stay wider. Eight bytes
  /// each.
  std::size_t most_points = 4'000'000;
  std::uint64_t seed = 0;  ///< of the random points
  Progress progress{};

  static constexpr double kConfidence = 0.99;
  static constexpr double kRelative = 2e-3, kNear = 2e-5, kOfNear = 0.03, kLeast = 1e-7, kRounding = 1e-6;
};

template <>
inline constexpr auto kOptions<MetricsOptions> = std::tuple{
    Option{.name = "tolerances",
           .member = &MetricsOptions::tolerances,
           .text = "Distances T for nsd(T), the surface Dice, precision(T), recall(T) and f_score(T).",
           .range = {.least = 0},
           .unit = "length",
           .value = "T,..."},
    Option{.name = "percentiles",
           .member = &MetricsOptions::percentiles,
           .text = "Percentiles P for hdP.",
           .range = {.least = 0, .most = 100, .above = true, .below = true},
           .value = "P,..."},
    Option{.name = "precision",
           .member = &MetricsOptions::precision,
           .text =
               "Bounds of distances at most this far apart; by default 0.2 % of their value, or up to 3 % "
               "where that is less than 2e-5 of the diagonal of both; 1e-7 of it at least. Of estimates: at "
               "most this far from the value.",
           .range = kPositive,
           .unit = "length",
           .value = "EPS"},
    Option{.name = "fraction_precision",
           .member = &MetricsOptions::fraction_precision,
           .text = "Bounds of fractions of the area at most this far apart.",
           .range = kPositive,
           .value = "EPS"},
    Option{.name = "estimate",
           .member = &MetricsOptions::estimate,
           .text =
               "In seconds, estimates from random points: each is within the printed bounds with a "
               "probability of 99 % at least, 0.2 % from their value where 4 million points of each mesh are "
               "enough; only hd is certain."}};

/// Distances from a surface A to a surface B: from each point p of A to the closest point of B, d(p),
/// weighted by the area of A.
struct DirectedMetrics {
  double area = 0;                           ///< of A
  std::size_t points = 0;                    ///< random ones of A, of an estimate
  BoundedNumber hausdorff{};                 ///< the largest d
  BoundedNumber mean{};                      ///< of d
  BoundedNumber rms{};                       ///< the root of the mean of d²
  std::vector<BoundedNumber> percentiles{};  ///< for each percentile P, the least t with d ≤ t on P % of A
  /// The fraction of A with d ≤ t for each tolerance t, in [0, 1]. Rounding exceeds no tolerance: t is
  /// kRounding of the diagonal of the box of both meshes more than given.
  std::vector<BoundedNumber> within{};
  /// The mean of |n(p)·n(q)| for the normals of the faces at p and at its closest point q, in [0, 1]: an
  /// estimate from the middles of all parts, as normals jump.
  double normal_consistency = 0;
};

template <>
inline constexpr std::tuple kFields<DirectedMetrics>{
    Field{"area", &DirectedMetrics::area, "The area of the surface that is measured from."},
    Field{"hausdorff", &DirectedMetrics::hausdorff, "The largest distance."},
    Field{"mean", &DirectedMetrics::mean, "The mean of the distances."},
    Field{"rms", &DirectedMetrics::rms, "The root of the mean of their squares."},
    Field{"points", &DirectedMetrics::points, "The number of random points that estimates are from."},
    Field{"percentiles", &DirectedMetrics::percentiles,
          "For each percentile, the least distance that so much of the area is within."},
    Field{"within", &DirectedMetrics::within,
          "For each tolerance, the fraction of the area that is within it."},
    Field{"normal_consistency", &DirectedMetrics::normal_consistency,
          "An estimate: the mean of the absolute cosines between the normals of both surfaces."}};

/// Measures of two surfaces A and B. M(A, B) is the mean of the distances from A to B, |A| the area of A.
struct SurfaceMetrics {
  std::array<DirectedMetrics, 2> from{};     ///< from A to B, from B to A
  BoundedNumber hausdorff{};                 ///< the larger one
  std::vector<BoundedNumber> percentiles{};  ///< for each percentile, the larger one of both directions
  BoundedNumber assd{};  ///< average symmetric surface distance: (|A| M(A, B) + |B| M(B, A)) / (|A| + |B|)
  BoundedNumber masd{};  ///< mean average surface distance: (M(A, B) + M(B, A)) / 2
  BoundedNumber rmsd{};  ///< the root of the mean of the squared distances of the points of both
  BoundedNumber chamfer_l1{};                 ///< M(A, B) + M(B, A)
  BoundedNumber chamfer_l2{};                 ///< the sum of both means of squared distances: an area
  std::vector<BoundedNumber> surface_dice{};  ///< for each tolerance, the fraction of both areas within it
  std::vector<BoundedNumber> f_score{};  ///< for each tolerance, the harmonic mean of both fractions within
  double normal_consistency = 0;         ///< the mean of both directions: an estimate
  /// The probability, at least, with which each number that is an estimate lies between its bounds; not that
  /// with which all do.
  double confidence = 1;
};

/// Computes the measures. By default nothing is sampled: on each part of a surface the distance lies between
/// two linear functions, whose integrals and distributions are known, and parts are divided until the bounds
/// are as close as the options ask. All bounds hold in spite of rounding. Points on faces without area count
/// for the Hausdorff distance only. The result does not depend on the number of threads.
///
/// With `estimate`, numbers are estimates from independent random points, uniform by area, with the exact
/// distance of each. In their bounds they are with a probability of at least kConfidence, whatever the
/// distances are: nothing is assumed about their distribution. The bounds are kRelative of a distance from it
/// at most, or `precision`, and `fraction_precision` from a fraction, unless that needs more than
/// `most_points`. Hausdorff distances are not estimated: these have bounds that hold, but are far apart.
/// Cost: a search for each point, and one for each face.
///
/// A mesh without faces is an empty surface: if both are empty, distances are 0 and fractions 1; if one is,
/// distances are infinite and fractions 0; these are exact.
///
/// Throws sdm::Error if a mesh is unusable for another reason (see validate) or its faces have no area, for
/// options out of range, or if there is not enough memory; Cancelled. Progress is one step, "metrics", whose
/// fraction never decreases. Cost: building the sites of both, the Hausdorff distance, a search for each
/// vertex, and a few for each face; more parts where surfaces cross and where they are closer than their
/// curvature.
[[nodiscard]] SDM_API SurfaceMetrics surface_metrics(const Mesh& a, const Mesh& b,
                                                     const MetricsOptions& options = {});

/// What a measure is a number of.
enum class MetricUnit { length, area, fraction };

/// A measure with the name by which users refer to it.
struct NamedMetric {
  std::string name;  ///< hd, hd95, assd, masd, rmsd, chamfer_l1, chamfer_l2, nsd(T), precision(T), recall(T),
                     ///< f_score(T), normal_consistency; T as short as it reads back
  BoundedNumber number{};
  MetricUnit unit = MetricUnit::length;
  std::optional<double> confidence{};  ///< SurfaceMetrics::confidence, of an estimate with bounds
};

/// Returns "hd95" for 95: the number as short as it reads back.
[[nodiscard]] SDM_API std::string percentile_name(double percent);
/// Returns "nsd(0.5)" for "nsd" and 0.5, likewise.
[[nodiscard]] SDM_API std::string metric_name(std::string_view kind, double tolerance);

/// Returns all measures of both surfaces, of metrics computed with these options. `precision(T)` is the
/// fraction of A within T of B, `recall(T)` that of B within T of A: B is the truth. Cost: O(n) in measures.
[[nodiscard]] SDM_API std::vector<NamedMetric> named_metrics(const SurfaceMetrics& metrics,
                                                             const MetricsOptions& options);

}  // namespace sdm
