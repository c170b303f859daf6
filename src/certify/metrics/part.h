// Integrals and distributions of linear functions on triangles.
#pragma once

#include <sdm/execution.h>
#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sites/sites_data.h"

namespace sdm::metrics {

/// A linear function on a triangle, by its values at the corners.
class Linear {
 public:
  Linear() = default;
  explicit Linear(const Vec3& at_corners);

  /// The mean of the positive part, max(0, f).
  [[nodiscard]] double mean() const;
  /// The mean of the square of the positive part.
  [[nodiscard]] double mean_square() const;
  /// The fraction of the area where f ≤ limit.
  [[nodiscard]] double fraction_within(double limit) const;
  [[nodiscard]] double least() const { return a_; }
  [[nodiscard]] double largest() const { return c_; }

 private:
  /// The fraction of the area next to the corner with value `at`, up to where the function is `limit`.
  [[nodiscard]] double fraction_at(double at, double limit, double other, double third) const;

  double a_ = 0, b_ = 0, c_ = 0;  // ascending
};

/// max(0, a, b) of two linear functions: the distance to a plane, or between two, where a triangle crosses
/// it. Exact unless a and b are both positive somewhere; then the mean and the mean square are upper bounds,
/// and the fraction within a limit is a lower one.
class TwoSided {
 public:
  TwoSided(const Vec3& a, const Vec3& b) : a_(a), b_(b) {}

  [[nodiscard]] double mean() const { return a_.mean() + b_.mean(); }
  [[nodiscard]] double mean_square() const { return a_.mean_square() + b_.mean_square(); }
  [[nodiscard]] double fraction_within(double limit) const;
  [[nodiscard]] double least() const;
  [[nodiscard]] double largest() const;

 private:
  Linear a_, b_;
};

/// A point of A, with bounds on its distance.
struct MeasuredPoint {
  Vec3 at{};
  std::uint32_t nearest = kNone;  ///< a face of B at most `upper` from it
  double lower = 0, upper = 0;
};

/// Points that are farther than so many times the accuracy of the cpu engine are measured by it alone.
inline constexpr double kFar = 1000;
/// kFar for points of which only a near face is needed.
inline constexpr double kFarFace = 30;

/// Measures points, which should be near each other if they are in the order, by the cpu engine, whose
/// distances are as accurate as `accuracy`, and those nearer than `far` times that to rounding. Cost: one or
/// two searches for each, all cores.
[[nodiscard]] std::vector<MeasuredPoint> measure(const sites::SitesData& b, std::span<const Vec3> points,
                                                 double accuracy, const Progress& progress,
                                                 double far = kFar);

/// A triangle of A or a part of one. The bounds on the distance d(x) of its points x are the larger of 0 and
/// of two linear functions each, with the values `low` and `high` at the corners; one function is 0 if the
/// other is enough.
///
/// high  The distance to one face of B is convex, so nowhere above what is linear between the corners.
///       Where the part crosses the plane of the face, at a distance of s(x) with a sign, and the place of x
///       in the plane is p(x) from the face, d ≤ |s| + p, of which p is convex too: the larger of s + p and
///       −s + p.
/// low   d²(x) − |x|², the minimum over q in B of |q|² − 2 x·q, is concave, so nowhere below what is linear
///       between the corners. With barycentric coordinates λ and sides e, |x|² is below that by Σ λᵢλⱼ eᵢⱼ²,
///       at most a third of the square of the longest side, G. So d² ≥ Σ λᵢ (dᵢ² − G), and as the root is
///       concave, d ≥ Σ λᵢ √(dᵢ² − G): close where the part is small beside its distance.
///       Elsewhere, `thorough`: for a face S of B and a unit vector g, d(x, S) ≥ g·x − max of g·y over S. The
///       minimum of such functions, over all S that may be closest somewhere, is concave too. Where the part
///       crosses B, there are two such minima, with unit vectors to either side of B: d is at least the
///       larger one. Above a single face, with the others beyond its sides, both are the distance to its
///       plane.
///
/// Where B is smooth, both differ from d by the square of the size of the part.
struct FacePart {
  std::array<MeasuredPoint, 3> corner{};
  std::uint32_t face = kNone;     ///< of A
  std::uint32_t nearest = kNone;  ///< a face of B closest to the middle
  bool thorough = false;          ///< `low` considers the faces nearby
  double area = 0;
  std::array<Vec3, 2> low{}, high{Vec3{kInfinity, kInfinity, kInfinity}, Vec3{}};

  [[nodiscard]] TwoSided lower() const { return {low[0], low[1]}; }
  [[nodiscard]] TwoSided upper() const { return {high[0], high[1]}; }
  /// The largest difference of the bounds.
  [[nodiscard]] double gap() const;
  /// How close its bounds can be.
  [[nodiscard]] double closest_bounds(double accuracy) const;
  /// The square of the longest side.
  [[nodiscard]] double squared_size() const;
  /// The corner that the longest side starts at.
  [[nodiscard]] int longest_side() const;
  [[nodiscard]] Vec3 middle() const;
};

/// Improves the bounds by the corners and the faces closest to them and to the middle, `nearest`.
void bound(const sites::SitesData& b, FacePart& part);

/// Improves the bounds by the faces of B nearby, the lower one if these are few.
void bound_thoroughly(const sites::SitesData& b, FacePart& part);

/// Where a part is cut: by a segment from `corner` to the side opposite, or between both sides at it.
struct Cut {
  int corner = 0;
  int points = 1;                      ///< 1: of the side opposite; 2: of the sides to the next two corners
  std::array<double, 2> at{0.5, 0.5};  ///< along each side

  /// The points where sides of the part are cut.
  [[nodiscard]] std::array<Vec3, 2> of(const FacePart& part) const;
};

/// Cuts a part that is near the surface along a side of the face that is nearest to its middle, so that one
/// piece lies above that face; otherwise at the middle of its longest side.
[[nodiscard]] Cut choose_cut(const sites::SitesData& b, const FacePart& part);

/// The pieces of a part that is cut at these points: two, or three for two points. Its bounds are those of
/// the pieces; `nearest` is not set.
[[nodiscard]] std::vector<FacePart> pieces(const FacePart& part, const Cut& cut,
                                           std::span<const MeasuredPoint> points);

}  // namespace sdm::metrics
