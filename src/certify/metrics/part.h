// A part of a face of A, and linear bounds on the distance of its points to B.
#pragma once

#include <sdm/progress.h>

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "certify/metrics/linear.h"
#include "sites/sites_data.h"

namespace sdm::metrics {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A point of A, with bounds on its distance.
struct MeasuredPoint {
  Vec3 at{};
  std::uint32_t nearest = kNone;  ///< a face of B at most `upper` from it
  double lower = 0, upper = 0;
};

/// Measures points, which should be near each other if they are in the order, by the cpu engine, whose
/// distances are as accurate as `accuracy`. Cost: one search for each, all cores.
[[nodiscard]] std::vector<MeasuredPoint> measure(const sites::SitesData& b, std::span<const Vec3> points,
                                                 double accuracy, const Progress& progress);

/// A triangle of A or a part of one. The linear functions that are `low` and `high` at the corners are bounds
/// on the distance d(x) of its points x:
///
/// high  The distance to one face of B is convex, so nowhere above what is linear between the corners.
/// low   d²(x) − |x|², the minimum over q in B of |q|² − 2 x·q, is concave, so nowhere below what is linear
///       between the corners. With barycentric coordinates λ and sides e, |x|² is below that by Σ λᵢλⱼ eᵢⱼ²,
///       at most a third of the square of the longest side, G. So d² ≥ Σ λᵢ (dᵢ² − G), and as the root is
///       concave, d ≥ Σ λᵢ √(dᵢ² − G): close where the part is small beside its distance.
///       Elsewhere, `thorough`: for a face S of B and a unit vector g, d(x, S) ≥ g·x − max of g·y over S. The
///       minimum of such functions, over all S that may be closest somewhere, is concave too.
///
/// Where B is smooth, both differ from d by the square of the size of the part.
struct Part {
  std::array<MeasuredPoint, 3> corner{};
  std::uint32_t face = kNone;     ///< of A
  std::uint32_t nearest = kNone;  ///< a face of B closest to the middle
  bool thorough = false;          ///< `low` considers the faces nearby
  double area = 0;
  Vec3 low{}, high{kInfinity, kInfinity, kInfinity};

  [[nodiscard]] Linear lower() const { return Linear(low); }
  [[nodiscard]] Linear upper() const { return Linear(high); }
  /// The largest difference of the bounds.
  [[nodiscard]] double gap() const;
  /// The square of the longest side.
  [[nodiscard]] double squared_size() const;
  /// The corner that the longest side starts at.
  [[nodiscard]] int longest_side() const;
  [[nodiscard]] Vec3 middle() const;
  [[nodiscard]] Vec3 middle_of_side() const;
};

/// Improves the bounds by the corners and the faces closest to them and to the middle, `nearest`.
void bound(const sites::SitesData& b, Part& part);

/// Improves the bounds by the faces of B nearby, the lower one if these are few.
void bound_thoroughly(const sites::SitesData& b, Part& part);

/// Halves a part at the middle of its longest side. Its bounds are those of the halves; `nearest` is not set.
[[nodiscard]] std::array<Part, 2> halves(const Part& part, const MeasuredPoint& middle_of_side);

}  // namespace sdm::metrics
