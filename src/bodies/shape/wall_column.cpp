#include "bodies/shape/wall_column.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <tuple>
#include <vector>

#include "bodies/shape/passages.h"
#include "closest/single_point.h"
#include "geometry/clip.h"
#include "geometry/unit_across.h"

namespace sdm::shape {
namespace {

// The plane of a triangle is of use for levels if it is less steep than that.
constexpr double kLeastCosine = 0.5;

// A part with more faces in its column has no bound.
constexpr std::size_t kMostInColumn = 64;

// The most depth of points between levels of the part that leave at the next exits above and below.
double between_exits(const Levels& part, const Levels& exits) {
  const double lo = std::max(part.lower, exits.lower), hi = std::min(part.upper, exits.upper);
  if (lo > hi) return 0;
  if (exits.lower == -kInfinity && exits.upper == kInfinity) return kInfinity;
  const double deepest = std::clamp(0.5 * (exits.lower + exits.upper), lo, hi);
  return std::min(deepest - exits.lower, exits.upper - deepest);
}

/// The bound of a part between the levels `taken` of faces, if what is at other levels is outside where
/// `is_outside` says so. Sorts them.
template <class IsOutside>
double bound_between(std::span<Levels> taken, const Levels& part, const Levels& limits, double least,
                     const IsOutside& is_outside) {
  std::ranges::sort(taken, {}, &Levels::lower);
  double bound = 0, lo = limits.lower, exit = -kInfinity;
  const auto pass = [&](double hi) {
    if (!(hi - lo > least) || !is_outside(0.5 * (lo + hi))) return;
    bound = std::max(bound, between_exits(part, {exit, lo}));
    exit = hi;
  };
  for (const Levels& t : taken) {
    pass(t.lower);
    lo = std::max(lo, t.upper);
  }
  pass(limits.upper);
  return std::max(bound, between_exits(part, {exit, kInfinity}));
}

bool outside(const sites::SitesData& solid, const inside::InsideTest& inside, const Vec3& p) {
  return !inside(p, closest::closest_point(solid, p, kInfinity));
}

}  // namespace

void Polygon::clip(double x, double y, double most) {
  std::array<double, kMostCorners> heights;
  bool cuts = false;
  for (std::size_t i = 0; i < count; ++i) {
    heights[i] = most - x * corners[i][1] - y * corners[i][2];
    cuts |= heights[i] < 0;
  }
  if (!cuts) return;
  Polygon rest;
  core::clip_convex(
      std::span<const double>(heights).first(count),
      [&](std::size_t i) { rest.corners[rest.count++] = corners[i]; },
      [&](std::size_t i, std::size_t j, double t) {
        rest.corners[rest.count++] = corners[i] + t * (corners[j] - corners[i]);
      });
  count = rest.count;
  std::copy_n(rest.corners.begin(), count, corners.begin());
}

WallColumn WallColumn::around(const Corners& triangle, const Vec3& origin, const Vec3& u) {
  WallColumn column{.origin = origin};
  Vec3 longest{};
  for (int k = 0; k < 3; ++k) {
    const Vec3 side = triangle[(k + 1) % 3] - triangle[k], across = side - dot(u, side) * u;
    if (squared_norm(across) > squared_norm(longest)) longest = across;
  }
  Vec3 v = normalized(longest);
  v = normalized(v - dot(u, v) * u);
  if (v == Vec3{}) v = unit_across(u);
  column.axes = {u, v, cross(u, v)};
  std::array<Vec3, 3> corners;
  for (int k = 0; k < 3; ++k)
    for (int a = 0; a < 3; ++a) corners[k][a] = dot(column.axes[a], triangle[k] - origin);
  for (int a = 0; a < 3; ++a)
    std::tie(column.lower[a], column.upper[a]) = std::minmax({corners[0][a], corners[1][a], corners[2][a]});
  for (int k = 0; k < 3; ++k) {
    const Vec3 &p = corners[k], &q = corners[(k + 1) % 3], &r = corners[(k + 2) % 3];
    double x = q[2] - p[2], y = p[1] - q[1];
    const double length = std::hypot(x, y);
    if (!(length > 0)) continue;
    x /= length;
    y /= length;
    // Towards the third corner, if the triangle is seen as a line.
    if (x * (r[1] - p[1]) + y * (r[2] - p[2]) > 0) {
      x = -x;
      y = -y;
    }
    column.sides[column.side_count++] = {
        x, y, std::max({x * p[1] + y * p[2], x * q[1] + y * q[2], x * r[1] + y * r[2]})};
  }
  const Vec3 n = cross(corners[1] - corners[0], corners[2] - corners[0]);
  if (std::abs(n[0]) > kLeastCosine * norm(n)) column.slope = Vec2{-n[1] / n[0], -n[2] / n[0]};
  return column;
}

void WallColumn::enlarge(double by) {
  for (const int a : {1, 2}) {
    lower[a] -= by;
    upper[a] += by;
  }
  for (std::size_t i = 0; i < side_count; ++i) sides[i][2] += by;
}

WallColumn WallColumn::around(const Ball& ball, const Vec3& u) {
  const Vec3 v = unit_across(u);
  WallColumn column{.origin = ball.centre, .axes = {u, v, cross(u, v)}};
  column.lower.fill(-ball.radius);
  column.upper.fill(ball.radius);
  return column;
}

double bound_in_column(const sites::SitesData& solid, const inside::InsideTest& inside,
                       const WallColumn& column, std::optional<int> winding, double enough) {
  thread_local std::vector<Polygon> faces;
  thread_local std::vector<Levels> taken;
  faces.clear();
  // Sections farther away would not bound anything by `enough`.
  const double reach = 2 * enough;
  const Passages passages(solid, column, {column.lower[0] - reach, column.upper[0] + reach}, kMostInColumn,
                          faces);
  if (passages.overflow()) return kInfinity;
  const double v = 0.5 * (column.lower[1] + column.upper[1]), w = 0.5 * (column.lower[2] + column.upper[2]);
  const double least = kLeastGap / solid.frame.scale;
  double best = kInfinity;
  for (const bool sloping : {false, true}) {
    if (best <= enough || (sloping && !column.slope)) break;
    const Vec2 slope = sloping ? *column.slope : Vec2{};
    const Levels part = sloping ? Levels{0, 0} : Levels{column.lower[0], column.upper[0]};
    const auto is_outside = [&](double level) {
      if (winding)
        if (const std::optional<int> change = passages.change(level)) return *winding + *change == 0;
      return outside(solid, inside,
                     column.origin + (level + slope[0] * v + slope[1] * w) * column.axes[0] +
                         v * column.axes[1] + w * column.axes[2]);
    };
    taken.clear();
    for (const Polygon& face : faces) taken.push_back(passages.levels(face, slope));
    best = std::min(best,
                    bound_between(taken, part, {part.lower - reach, part.upper + reach}, least, is_outside));
  }
  return best;
}

}  // namespace sdm::shape
