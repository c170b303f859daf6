#include "bodies/convex/difference_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "geometry/point_triangle.h"
#include "geometry/unit_across.h"

namespace sdm::convex {
namespace {

constexpr double kPrecision = 1e-10;    // of the exit, relative to the size
constexpr double kFlat = 1e-11;         // a difference that is thinner, relative to the size, is flat
constexpr double kOffGrid = 2e-12;      // of the size: what rounding to the grid moves a point by
constexpr double kNormalError = 4e-16;  // of a normal, relative to the ratio of sides to height
constexpr double kHeightError = 1e-14;  // of a height along a normal, relative to squared sides and the size
constexpr double kSliver = 1e4;         // that ratio of a face whose normal is not used
constexpr double kRounding = 1e-14;     // of a distance, relative to the corners
constexpr std::size_t kMostPoints = 20000;

using Facet = ExitWorkspace::Facet;
using GridPoint = ExitWorkspace::Point;

__extension__ using Integer = __int128;

// The sign of (d − a)·((b − a) × (c − a)), exactly: coordinates are at most 2^40, differences 2^41, and the
// six products at most 6 · 2^123.
int side_of_plane(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  std::array<std::int64_t, 3> u, v, w;
  for (int k = 0; k < 3; ++k) {
    u[k] = b.grid[k] - a.grid[k];
    v[k] = c.grid[k] - a.grid[k];
    w[k] = d.grid[k] - a.grid[k];
  }
  const auto minor = [&](int i, int j) { return Integer{u[i]} * v[j] - Integer{u[j]} * v[i]; };
  const Integer determinant = w[0] * minor(1, 2) + w[1] * minor(2, 0) + w[2] * minor(0, 1);
  return (determinant > 0) - (determinant < 0);
}

// Points of multiples of a power of two.
class Grid {
 public:
  explicit Grid(double size) : to_(std::ldexp(1, 39 - std::ilogb(size))), from_(1 / to_) {}

  [[nodiscard]] GridPoint operator()(const SimplexPoint& p) const {
    GridPoint point{p, {}, 0};
    for (int k = 0; k < 3; ++k) {
      constexpr double kShift = 0x3p51;  // numbers of this size are integers
      const double rounded = (to_ * p.w[k] + kShift) - kShift;
      point.w[k] = from_ * rounded;
      point.grid[k] = static_cast<std::int64_t>(rounded);
    }
    point.distance = norm(point.w);
    return point;
  }

 private:
  double to_, from_;  // exact, as are products with them
};

// The hull of points of the difference. Its faces are triangles, counter-clockwise from outside.
class DifferenceHull {
 public:
  // Four points that are not in a plane.
  DifferenceHull(const std::array<GridPoint, 4>& p, double size, ExitWorkspace& workspace)
      : size_(size), w_(workspace) {
    w_.points.assign(p.begin(), p.end());
    w_.facets.clear();
    w_.order.clear();
    if (side_of_plane(p[0], p[1], p[2], p[3]) > 0) std::swap(w_.points[0], w_.points[1]);
    constexpr std::array<std::array<std::uint32_t, 3>, 4> kCorners{
        {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
    constexpr std::array<std::array<std::uint32_t, 3>, 4> kAcross{
        {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}}};
    for (std::size_t f = 0; f < 4; ++f) add(kCorners[f], kAcross[f]);
  }

  [[nodiscard]] double least(std::uint32_t f) const { return w_.facets[f].least; }
  [[nodiscard]] std::array<std::uint32_t, 2> vertices_of(std::uint32_t f) const {
    return w_.points[w_.facets[f].corner[0]].vertices;
  }
  [[nodiscard]] Simplex simplex_of(std::uint32_t f) const {
    Simplex simplex;
    for (const std::uint32_t corner : w_.facets[f].corner)
      if (const auto& vertices = w_.points[corner].vertices; vertices[0] != kNone)
        simplex.vertices[simplex.count++] = vertices;
    return simplex;
  }
  // A unit vector away from the origin: the normal, or to the closest point of a sliver.
  [[nodiscard]] Vec3 out_of(std::uint32_t f) const {
    const Facet& facet = w_.facets[f];
    if (facet.reliable) return normalized(facet.normal);
    return (origin_beyond(facet) ? -1.0 : 1.0) * normalized(closest_to_origin(facet));
  }
  [[nodiscard]] std::size_t size() const { return w_.points.size(); }

  // Faces that are added from now on are left out by nearest() if they are farther.
  void leave_out_beyond(double distance) { beyond_ = distance; }
  // The face nearest to the origin; kNone if it is among those that were left out.
  std::uint32_t nearest() {
    while (!w_.order.empty() && w_.facets[w_.order.front().second].removed) pop();
    return w_.order.empty() ? kNone : w_.order.front().second;
  }

  // Adds a point, if it is outside, most likely above this face. Returns whether it is.
  bool add_point(std::uint32_t above, const GridPoint& p) {
    for (std::uint32_t f = 0; !sees(p, above); above = f++) {
      while (f < w_.facets.size() && w_.facets[f].removed) ++f;
      if (f == w_.facets.size()) return false;
    }
    const auto point = static_cast<std::uint32_t>(w_.points.size());
    w_.points.push_back(p);
    if (w_.from.size() < w_.points.size()) w_.from.resize(2 * w_.points.size());
    find_horizon(above, p);
    // The horizon is a closed line: each of its corners begins one side, and p is collinear with none, as it
    // would otherwise be in the planes of both faces there.
    const auto first = static_cast<std::uint32_t>(w_.facets.size());
    for (const auto& [face, side] : w_.horizon) {
      const std::array<std::uint32_t, 3>& corner = w_.facets[face].corner;
      const std::uint32_t from = corner[(side + 1) % 3], to = corner[side];
      const auto added = static_cast<std::uint32_t>(w_.facets.size());
      w_.facets[face].across[side] = added;
      w_.from[from] = added;
      add({from, to, point}, {face, 0, 0});
    }
    for (std::uint32_t f = first; f < w_.facets.size(); ++f) {
      const std::uint32_t next = w_.from[w_.facets[f].corner[1]];
      w_.facets[f].across[1] = next;
      w_.facets[next].across[2] = f;
    }
    return true;
  }

 private:
  [[nodiscard]] bool sees(const GridPoint& p, std::uint32_t face) const {
    const Facet& facet = w_.facets[face];
    const auto& [a, b, c] = facet.corner;
    const double height = dot(facet.normal, p.w - w_.points[a].w);
    if (std::abs(height) > facet.doubt) return height > 0;
    return side_of_plane(w_.points[a], w_.points[b], w_.points[c], p) > 0;
  }

  void add(const std::array<std::uint32_t, 3>& corner, const std::array<std::uint32_t, 3>& across) {
    const GridPoint &p = w_.points[corner[0]], &q = w_.points[corner[1]], &r = w_.points[corner[2]];
    const Vec3 u = q.w - p.w, v = r.w - p.w;
    Facet facet{.corner = corner, .across = across, .normal = cross(u, v)};
    const double area = norm(facet.normal),
                 sides = std::max({squared_norm(u), squared_norm(v), squared_norm(v - u)});
    const double far = std::max({p.distance, q.distance, r.distance});
    facet.doubt = kHeightError * sides * size_;
    facet.reliable = sides < kSliver * area;
    if (facet.reliable)
      facet.least = (dot(facet.normal, p.w) - kNormalError * far * (area + sides)) / area;
    else
      facet.least = (origin_beyond(facet) ? -1 : 1) * norm(closest_to_origin(facet)) - kRounding * far;
    const auto number = static_cast<std::uint32_t>(w_.facets.size());
    w_.facets.push_back(facet);
    if (facet.least > beyond_) return;
    w_.order.emplace_back(facet.least, number);
    std::push_heap(w_.order.begin(), w_.order.end(), std::greater{});
  }
  // The nearest face of all is as far as its closest point is.
  [[nodiscard]] Vec3 closest_to_origin(const Facet& facet) const {
    const auto& [a, b, c] = facet.corner;
    return closest_on_triangle({}, {w_.points[a].w, w_.points[b].w, w_.points[c].w});
  }
  [[nodiscard]] bool origin_beyond(const Facet& facet) const {
    const auto& [a, b, c] = facet.corner;
    return side_of_plane(w_.points[a], w_.points[b], w_.points[c], {}) > 0;
  }
  void pop() {
    std::pop_heap(w_.order.begin(), w_.order.end(), std::greater{});
    w_.order.pop_back();
  }

  // Removes the faces that p sees, which are connected, and collects the sides of those around them.
  void find_horizon(std::uint32_t above, const GridPoint& p) {
    w_.horizon.clear();
    w_.open.clear();
    w_.open.push_back(above);
    w_.facets[above].removed = true;
    while (!w_.open.empty()) {
      const std::uint32_t face = w_.open.back();
      w_.open.pop_back();
      for (const std::uint32_t next : w_.facets[face].across) {
        Facet& beyond = w_.facets[next];
        if (beyond.removed) continue;
        if (sees(p, next)) {
          beyond.removed = true;
          w_.open.push_back(next);
          continue;
        }
        const auto side = std::ranges::find(beyond.across, face) - beyond.across.begin();
        w_.horizon.emplace_back(next, static_cast<std::uint32_t>(side));
      }
    }
  }

  const double size_;
  double beyond_ = kInfinity;
  ExitWorkspace& w_;
};

// Finds the exit, and its first directions.
class ExitSearch {
 public:
  ExitSearch(const Support& support, const Vec3& first, double size, ExitWorkspace& workspace)
      : support_(support), first_(first), size_(size), grid_(size), workspace_(workspace) {}

  ConvexExit find() {
    std::array<GridPoint, 4> corner;
    if (!find_simplex(corner)) {
      exit_.lower = std::min(0.0, exit_.upper);
      return exit_;
    }
    DifferenceHull hull(corner, size_, workspace_);
    while (true) {
      const std::uint32_t nearest = hull.nearest();
      if (nearest == kNone) {
        exit_.lower = exit_.upper;
        break;
      }
      exit_.touching = hull.simplex_of(nearest);
      exit_.lower = hull.least(nearest) - kOffGrid * size_;
      if (exit_.upper - exit_.lower <= kPrecision * size_ || exit_.upper < 0) break;
      const Vec3 out = hull.out_of(nearest);
      if (out == Vec3{}) break;
      const GridPoint p = farthest(out, hull.vertices_of(nearest));
      hull.leave_out_beyond(exit_.upper + kOffGrid * size_);
      if (hull.size() >= kMostPoints || !hull.add_point(nearest, p)) break;
    }
    exit_.lower = std::min(exit_.lower, exit_.upper);
    return exit_;
  }

 private:
  // The point of the difference that is farthest along u, which bounds the exit.
  GridPoint farthest(const Vec3& u, const std::array<std::uint32_t, 2>& near = {kNone, kNone}) {
    const SimplexPoint p = support_(u, near);
    if (const double along = dot(u, p.w); along < exit_.upper) {
      exit_.upper = along;
      exit_.direction = u;
    }
    return grid_(p);
  }
  // Some point along u, or along −u, for which far(p) is more than `enough`, if there is one.
  template <class Far>
  bool find_far(const Vec3& u, const Far& far, double enough, GridPoint& p) {
    p = farthest(u);
    if (far(p.w) > enough) return true;
    p = farthest(-u);
    return far(p.w) > enough;
  }

  // The first two points are the farthest ones towards and away from the origin.
  bool find_simplex(std::array<GridPoint, 4>& corner) {
    const double flat = kFlat * size_;
    const auto from_first = [&](const Vec3& p) { return norm(p - corner[0].w); };
    corner[0] = farthest(first_);
    const Vec3 beside = unit_across(first_);
    if (!find_far(-first_, from_first, flat, corner[1]) && !find_far(beside, from_first, flat, corner[1]) &&
        !find_far(cross(first_, beside), from_first, flat, corner[1]))
      return false;
    const Vec3 line = normalized(corner[1].w - corner[0].w), side = unit_across(line);
    const auto from_line = [&](const Vec3& p) { return norm(cross(line, p - corner[0].w)); };
    if (!find_far(side, from_line, flat, corner[2]) &&
        !find_far(cross(line, side), from_line, flat, corner[2]))
      return false;
    const Vec3 normal = normalized(cross(corner[1].w - corner[0].w, corner[2].w - corner[0].w));
    const auto from_plane = [&](const Vec3& p) { return std::abs(dot(normal, p - corner[0].w)); };
    return find_far(normal, from_plane, flat, corner[3]) &&
           side_of_plane(corner[0], corner[1], corner[2], corner[3]) != 0;
  }

  const Support& support_;
  const Vec3 first_;
  double size_;
  Grid grid_;
  ExitWorkspace& workspace_;
  ConvexExit exit_{.upper = kInfinity};
};

}  // namespace

ConvexExit exit_of_hulls(const Support& support, const Vec3& first, double size, ExitWorkspace& workspace) {
  return ExitSearch(support, first == Vec3{} ? Vec3{1, 0, 0} : first, size, workspace).find();
}

}  // namespace sdm::convex
