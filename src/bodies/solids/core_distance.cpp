#include "bodies/solids/core_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "bodies/convex/simplex_point.h"
#include "geometry/unit_across.h"

namespace sdm::solids {
namespace {

constexpr int kMostSteps = 256;
constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
constexpr double kClosest = 1e-13;  // of the coordinates: closest points are found up to that
constexpr double kReliable =
    1e-9;  // of the size: a distance with a larger error may be one of cores that overlap
constexpr double kTouching = 1e-12;  // of the size: a distance whose direction is not reliable
constexpr double kMostTilt = 5e-8;   // of the size: what axes that are parallel may be turned by

// The points of both cores that belong to the points of a simplex.
class Pairs {
 public:
  [[nodiscard]] convex::SimplexPoint add(const Vec3& a, const Vec3& b, std::uint32_t number) {
    const std::uint32_t slot = number % kSlots;
    points_[slot] = {a, b};
    return {{slot, number}, a - b};
  }
  // The weights of the points of the simplex with which they make v.
  void place(const convex::SimplexPoints& simplex, const Vec3& v, Vec3& a, Vec3& b) const {
    const std::array<double, 3> weights = weights_of(simplex, v);
    a = b = {};
    for (int i = 0; i < simplex.count; ++i) {
      const auto& [of_a, of_b] = points_[simplex.points[i].vertices[0]];
      a += weights[i] * of_a;
      b += weights[i] * of_b;
    }
  }

 private:
  static constexpr std::uint32_t kSlots = kMostSteps + 1;

  static std::array<double, 3> weights_of(const convex::SimplexPoints& simplex, const Vec3& v) {
    const auto& p = simplex.points;
    if (simplex.count == 1) return {1, 0, 0};
    const Vec3 ab = p[1].w - p[0].w, at = v - p[0].w;
    if (simplex.count == 2) {
      const double t = std::clamp(dot(at, ab) / squared_norm(ab), 0.0, 1.0);
      return {1 - t, t, 0};
    }
    const Vec3 ac = p[2].w - p[0].w, n = cross(ab, ac);
    const double area = squared_norm(n);
    const double s = std::clamp(dot(cross(at, ac), n) / area, 0.0, 1.0);
    const double t = std::clamp(dot(cross(ab, at), n) / area, 0.0, 1 - s);
    return {1 - s - t, s, t};
  }

  std::array<std::array<Vec3, 2>, kSlots> points_;
};

// The normal of two segments with a point in common.
Vec3 normal_of_crossing(const PosedCore& a, const PosedCore& b) {
  const Vec3 between = a.centre() - b.centre();
  Vec3 n = cross(a.half(), b.half());
  if (const double length = norm(n); length > kTouching * norm(a.half()) * norm(b.half()))
    n = (1 / length) * n;
  else
    n = unit_across(a.half() != Vec3{} ? a.axis() : b.axis());
  return dot(n, between) < 0 ? -n : n;
}

}  // namespace

// v is the point of the simplex that is closest to the origin, and the support along −v a lower bound.
CoreDistance core_gap(const PosedCore& a, const PosedCore& b) {
  std::uint32_t near_a = kNone, near_b = kNone;
  convex::SimplexPoints simplex;
  Pairs pairs;
  Vec3 u = b.centre() - a.centre();
  u = u == Vec3{} ? Vec3{0, 0, 1} : normalized(u);
  Vec3 v{};
  double distance = kInfinity, lower = 0, scale = 0;
  for (std::uint32_t step = 0; step < kMostSteps; ++step) {
    const Vec3 of_a = a.support(u, near_a), of_b = b.support(-u, near_b);
    scale = std::max({scale, std::abs(of_a[0]), std::abs(of_a[1]), std::abs(of_a[2]), std::abs(of_b[0]),
                      std::abs(of_b[1]), std::abs(of_b[2])});
    const convex::SimplexPoint next = pairs.add(of_a, of_b, step);
    if (step > 0) {
      lower = std::max(lower, -dot(u, next.w));
      if (distance - lower <= kClosest * scale) break;
      const auto same = [&](const convex::SimplexPoint& p) { return p.w == next.w; };
      if (std::any_of(simplex.points.begin(), simplex.points.begin() + simplex.count, same)) break;
    }
    const convex::SimplexPoints before = simplex;
    const Vec3 last = v;
    simplex.add(next);
    const bool encloses = !simplex.reduce(v);
    if (encloses && lower <= kRounding * scale && simplex.depth_of_origin() > 0) return {.overlapping = true};
    const double now = encloses ? distance : norm(v);
    if (now <= kRounding * scale) return {};
    if (!(now < distance)) {  // by rounding, nothing closer is found
      simplex = before;
      v = last;
      break;
    }
    distance = now;
    u = (-1 / now) * v;
  }
  CoreDistance found{
      .distance = distance, .error = std::max(0.0, distance - lower), .normal = (1 / distance) * v};
  pairs.place(simplex, v, found.point1, found.point2);
  return found;
}

// The axis is a rectangle in the half-plane of the point: above and beside it by `along` and `aside`.
CoreDistance point_to_axis(const Vec3& point, const PosedCore& axis) {
  const Vec3 from = point - axis.centre();
  if (axis.point())
    if (const double distance = norm(from); distance > 0)
      return {
          .distance = distance, .normal = (1 / distance) * from, .point1 = point, .point2 = axis.centre()};
  const double height = dot(from, axis.axis());
  const Vec3 up = height < 0 ? -axis.axis() : axis.axis();
  const Vec3 beside = from - height * axis.axis();
  const double length = norm(beside);
  Vec3 outwards = length > 0 ? (1 / length) * beside : unit_across(axis.axis());
  outwards =
      normalized(outwards - dot(outwards, axis.axis()) * axis.axis());  // beside may be of rounding alone
  const double along = std::abs(height) - norm(axis.half()), aside = length - axis.disc();
  CoreDistance found;
  if (along > 0 && aside > 0) {
    found.distance = std::hypot(along, aside);
    found.normal = (1 / found.distance) * (along * up + aside * outwards);
  } else {
    found.distance = std::max(along, aside);
    found.normal = along > aside ? up : outwards;
  }
  found.point1 = point;
  found.point2 = point - found.distance * found.normal;
  return found;
}

namespace {

// Of O2 from O1 for that of O1 from O2.
void swap_cores(CoreDistance& found) {
  found.normal = -found.normal;
  std::swap(found.point1, found.point2);
}

// The point of a segment that is closest to an axis. The signed distance is convex along the segment: it is
// least between a point where it falls and one where it grows, and no less than where their tangents meet.
CoreDistance segment_to_axis(const PosedCore& segment, const PosedCore& axis) {
  struct At : CoreDistance {
    double t, slope;
  };
  const auto at = [&](double t) {
    At found{point_to_axis(segment.centre() + t * segment.half(), axis), t, 0};
    found.slope = dot(found.normal, segment.half());
    return found;
  };
  constexpr int kMostTries = 100;
  At low = at(-1), high = at(1);
  if (low.slope >= 0) return low;
  if (high.slope <= 0) return high;
  double before = 2 * (high.t - low.t);  // the interval two tries ago
  double last = before;
  for (int i = 0; i < kMostTries; ++i) {
    const At& best = low.distance < high.distance ? low : high;
    const double meet =
        (high.distance - low.distance + low.slope * low.t - high.slope * high.t) / (low.slope - high.slope);
    const double least = low.distance + low.slope * (meet - low.t);
    const double length = high.t - low.t;
    if (best.distance - least <= kRounding * (std::abs(best.distance) + norm(segment.half()))) break;
    const double t = 2 * length > before || !(meet > low.t && meet < high.t) ? low.t + 0.5 * length : meet;
    before = std::exchange(last, length);
    if (!(t > low.t && t < high.t)) break;
    (at(t).slope < 0 ? low : high) = at(t);
  }
  return low.distance < high.distance ? low : high;
}

// Two axes with the same direction: their difference is one about it. As large as that changes the second by
// `tilt`, at most, it changes the distance.
CoreDistance parallel_axes(const PosedCore& a, const PosedCore& b) {
  const double half_a = norm(a.half()), half_b = norm(b.half());
  const PosedCore sum(b.centre(), a.axis(), half_a + half_b, a.disc() + b.disc());
  CoreDistance found = point_to_axis(a.centre(), sum);
  // A point of the sum is one of each, in parts.
  const Vec3 from = found.point2 - b.centre();
  const double along = dot(from, a.axis());
  const Vec3 beside = from - along * a.axis();
  const double disc = a.disc() + b.disc(), half = half_a + half_b;
  found.point2 = b.centre() + (half > 0 ? half_b / half * along : 0.0) * a.axis() +
                 (disc > 0 ? b.disc() / disc : 0.0) * beside;
  found.point1 = found.point2 + found.distance * found.normal;
  return found;
}

// How far the points of b move if it is turned until its axis is that of a.
double tilt_of(const PosedCore& a, const PosedCore& b) {
  return norm(cross(a.axis(), b.axis())) * (norm(b.half()) + b.disc());
}

}  // namespace

QuickDistance quick_distance(const PosedCore& a, const PosedCore& b, double size) {
  const bool axes = a.kind() == CoreKind::axis && b.kind() == CoreKind::axis;
  if (a.point() && axes) return {point_to_axis(a.centre(), b), true};
  if (b.point() && axes) {
    QuickDistance found{point_to_axis(b.centre(), a), true};
    swap_cores(found);
    return found;
  }
  if (axes && a.disc() + b.disc() > 0)
    if (const double tilt = std::min(tilt_of(a, b), tilt_of(b, a)); tilt <= kMostTilt * size) {
      QuickDistance found{parallel_axes(a, b), true};
      found.error = tilt;
      // The direction is reliable as far as the distance is.
      if (found.distance < 0 || tilt <= kClosest * size) return found;
    }
  QuickDistance found;
  if (a.thin() && axes && b.disc() > 0) {
    static_cast<CoreDistance&>(found) = segment_to_axis(a, b);
    found.overlapping = found.distance < -kTouching * size;
  } else if (b.thin() && axes && a.disc() > 0) {
    static_cast<CoreDistance&>(found) = segment_to_axis(b, a);
    swap_cores(found);
    found.overlapping = found.distance < -kTouching * size;
  } else {
    static_cast<CoreDistance&>(found) = core_gap(a, b);
  }
  found.known = found.distance > kTouching * size && found.error <= kReliable * size;
  if (found.known || !a.thin() || !b.thin()) return found;
  // Both segments touch, to rounding. The points are closest ones of both segments.
  found.known = true;
  found.normal = normal_of_crossing(a, b);
  if (found.distance == 0) {
    const CoreDistance beside = core_gap(a.moved(size * found.normal), b);
    found.point1 = found.point2 = beside.point2;
  }
  return found;
}

CoreDistance core_distance(const PosedCore& a, const PosedCore& b, double size,
                           convex::ExitWorkspace& workspace) {
  return core_distance(a, b, size, quick_distance(a, b, size), workspace);
}

CoreDistance core_distance(const PosedCore& a, const PosedCore& b, double size, const QuickDistance& quick,
                           convex::ExitWorkspace& workspace) {
  CoreDistance found = quick;
  if (quick.known) return found;
  const convex::ConvexExit exit = convex::exit_of_hulls(
      [&](const Vec3& u, const std::array<std::uint32_t, 2>& near) {
        convex::SimplexPoint point{near, {}};
        point.w = a.support(u, point.vertices[0]) - b.support(-u, point.vertices[1]);
        return point;
      },
      a.centre() == b.centre() ? Vec3{} : normalized(b.centre() - a.centre()), size, workspace);
  if (exit.upper < 0) {
    found.error = std::max(0.0, std::min(found.error, found.distance + exit.upper));
    return found;
  }
  found.distance = -exit.upper;
  found.error = exit.upper - exit.lower;
  found.normal = -exit.direction;
  // Beyond the exit, the closest points are above each other along the normal.
  const Vec3 out = (exit.upper + size) * found.normal;
  const CoreDistance beside = core_gap(a.moved(out), b);
  found.point1 = beside.point1 - out;
  found.point2 = found.point1 - found.distance * found.normal;
  return found;
}

}  // namespace sdm::solids
