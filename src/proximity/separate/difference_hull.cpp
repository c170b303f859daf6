#include "proximity/separate/difference_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "geometry/point_triangle.h"
#include "geometry/predicates.h"

namespace sdm::separate {
namespace {

constexpr double kPrecision = 1e-10;    // of the exit, relative to the size
constexpr double kFlat = 1e-13;         // a difference that is thinner, relative to the size, is flat
constexpr double kNormalError = 4e-16;  // of a normal, relative to the ratio of sides to height
constexpr double kSliver = 1e4;         // that ratio of a face whose normal is not used
constexpr double kRounding = 1e-14;     // of a distance, relative to the corners
constexpr std::size_t kMostPoints = 20000;

// The hull of points of the difference. Its faces are triangles, counter-clockwise from outside.
class DifferenceHull {
 public:
  using Facet = ExitWorkspace::Facet;

  // Four points that are not in a plane.
  DifferenceHull(const std::array<Vec3, 4>& p, ExitWorkspace& workspace)
      : points_(workspace.points),
        facets_(workspace.facets),
        order_(workspace.order),
        horizon_(workspace.horizon),
        open_(workspace.open),
        seen_(workspace.seen) {
    points_.assign(p.begin(), p.end());
    facets_.clear(), order_.clear(), seen_.clear();
    if (orientation(p[0], p[1], p[2], p[3]) > 0) std::swap(points_[0], points_[1]);
    constexpr std::array<std::array<std::uint32_t, 3>, 4> kCorners{
        {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
    constexpr std::array<std::array<std::uint32_t, 3>, 4> kAcross{
        {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}}};
    for (std::size_t f = 0; f < 4; ++f) add(kCorners[f], kAcross[f]);
  }

  [[nodiscard]] const Facet& facet(std::uint32_t f) const { return facets_[f]; }
  [[nodiscard]] std::size_t size() const { return points_.size(); }

  // The face nearest to the origin.
  std::uint32_t nearest() {
    while (facets_[order_.front().second].removed) pop();
    return order_.front().second;
  }

  // Adds a point, if it is outside, most likely above this face. Returns whether it is.
  bool add_point(std::uint32_t above, const Vec3& p) {
    for (std::uint32_t f = 0; !sees(p, above); above = f++) {
      while (f < facets_.size() && facets_[f].removed) ++f;
      if (f == facets_.size()) return false;
    }
    const auto point = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
    find_horizon(above, p);
    // The horizon is a closed line: each of its corners begins one side, and p is collinear with none, as it
    // would otherwise be in the planes of both faces there.
    const auto first = static_cast<std::uint32_t>(facets_.size());
    for (const auto& [face, side] : horizon_) {
      const Facet& beyond = facets_[face];
      const std::uint32_t from = beyond.corner[(side + 1) % 3], to = beyond.corner[side];
      const auto added = static_cast<std::uint32_t>(facets_.size());
      facets_[face].across[side] = added;
      add({from, to, point}, {face, 0, 0});
    }
    for (std::uint32_t f = first; f < facets_.size(); ++f)
      for (std::uint32_t g = first; g < facets_.size(); ++g)
        if (facets_[f].corner[1] == facets_[g].corner[0]) facets_[f].across[1] = g, facets_[g].across[2] = f;
    return true;
  }

 private:
  [[nodiscard]] bool sees(const Vec3& p, std::uint32_t face) const {
    const auto& [a, b, c] = facets_[face].corner;
    return orientation(points_[a], points_[b], points_[c], p) > 0;
  }

  void add(const std::array<std::uint32_t, 3>& corner, const std::array<std::uint32_t, 3>& across) {
    const Vec3 &a = points_[corner[0]], &b = points_[corner[1]], &c = points_[corner[2]];
    const Vec3 twice_area = cross(b - a, c - a);
    const double area = norm(twice_area),
                 sides = std::max({squared_norm(b - a), squared_norm(c - a), squared_norm(c - b)});
    Facet facet{.corner = corner, .across = across};
    const double far = std::sqrt(std::max({squared_norm(a), squared_norm(b), squared_norm(c)}));
    if (sides < kSliver * area) {
      facet.out = (1 / area) * twice_area;
      facet.least = dot(facet.out, a) - kNormalError * far * (1 + sides / area);
    } else {
      // The nearest face of all is as far as its closest point is.
      const Vec3 closest = closest_on_triangle({}, {a, b, c});
      const bool beyond = orientation(a, b, c, {}) > 0;
      facet.out = (beyond ? -1.0 : 1.0) * normalized(closest);
      facet.least = (beyond ? -1 : 1) * norm(closest) - kRounding * far;
    }
    order_.emplace_back(facet.least, static_cast<std::uint32_t>(facets_.size()));
    std::push_heap(order_.begin(), order_.end(), std::greater{});
    facets_.push_back(facet);
  }
  void pop() {
    std::pop_heap(order_.begin(), order_.end(), std::greater{});
    order_.pop_back();
  }

  // Removes the faces that p sees, which are connected, and collects the sides of those around them.
  void find_horizon(std::uint32_t above, const Vec3& p) {
    horizon_.clear();
    open_.assign(1, above);
    facets_[above].removed = true;
    while (!open_.empty()) {
      const std::uint32_t face = open_.back();
      open_.pop_back();
      for (const std::uint32_t next : facets_[face].across) {
        if (facets_[next].removed) continue;
        if (sees(p, next)) {
          facets_[next].removed = true;
          open_.push_back(next);
        }
      }
      seen_.push_back(face);
    }
    for (const std::uint32_t face : seen_)
      for (const std::uint32_t next : facets_[face].across) {
        if (facets_[next].removed) continue;
        for (std::uint32_t side = 0; side < 3; ++side)
          if (facets_[next].across[side] == face) horizon_.emplace_back(next, side);
      }
    std::ranges::sort(horizon_);
    horizon_.erase(std::unique(horizon_.begin(), horizon_.end()), horizon_.end());
    seen_.clear();
  }

  std::vector<Vec3>& points_;
  std::vector<Facet>& facets_;
  std::vector<std::pair<double, std::uint32_t>>& order_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>>& horizon_;
  std::vector<std::uint32_t>&open_, &seen_;
};

// Some unit vector across u.
Vec3 across(const Vec3& u) {
  const Vec3 axis = std::abs(u[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return normalized(cross(u, axis));
}

// Finds the exit, and its first directions.
class ExitSearch {
 public:
  ExitSearch(const Support& support, double size, ExitWorkspace& workspace)
      : support_(support), size_(size), workspace_(workspace) {}

  ConvexExit find() {
    std::array<Vec3, 4> corner;
    if (!find_simplex(corner)) {
      exit_.lower = std::min(0.0, exit_.upper);
      return exit_;
    }
    DifferenceHull hull(corner, workspace_);
    while (true) {
      const std::uint32_t nearest = hull.nearest();
      exit_.lower = hull.facet(nearest).least;
      if (exit_.upper - exit_.lower <= kPrecision * size_ || exit_.upper < 0) break;
      const Vec3 out = hull.facet(nearest).out;
      if (out == Vec3{}) break;
      const Vec3 p = farthest(out);
      if (hull.size() >= kMostPoints || !hull.add_point(nearest, p)) break;
    }
    exit_.lower = std::min(exit_.lower, exit_.upper);
    return exit_;
  }

 private:
  // The point of the difference that is farthest along u, which bounds the exit.
  Vec3 farthest(const Vec3& u) {
    const Vec3 p = support_(u).difference();
    if (dot(u, p) < exit_.upper) exit_.upper = dot(u, p), exit_.direction = u;
    return p;
  }
  // That of the two along u and −u for which far(p) is larger.
  template <class Far>
  Vec3 farther(const Vec3& u, const Far& far) {
    const Vec3 p = farthest(u), q = farthest(-u);
    return far(p) >= far(q) ? p : q;
  }

  bool find_simplex(std::array<Vec3, 4>& corner) {
    const auto from_first = [&](const Vec3& p) { return norm(p - corner[0]); };
    corner[0] = farthest({1, 0, 0});
    corner[1] = farther({-1, 0, 0}, from_first);
    for (int k = 1; k < 3 && from_first(corner[1]) <= kFlat * size_; ++k) {
      Vec3 axis{};
      axis[k] = 1;
      corner[1] = farther(axis, from_first);
    }
    const Vec3 line = normalized(corner[1] - corner[0]);
    const auto from_line = [&](const Vec3& p) { return norm(cross(line, p - corner[0])); };
    const Vec3 side = across(line);
    corner[2] = farther(side, from_line);
    if (from_line(corner[2]) <= kFlat * size_) corner[2] = farther(cross(line, side), from_line);
    const Vec3 normal = normalized(cross(corner[1] - corner[0], corner[2] - corner[0]));
    if (normal == Vec3{}) return false;
    const auto from_plane = [&](const Vec3& p) { return std::abs(dot(normal, p - corner[0])); };
    corner[3] = farther(normal, from_plane);
    return from_plane(corner[3]) > kFlat * size_ &&
           orientation(corner[0], corner[1], corner[2], corner[3]) != 0;
  }

  const Support& support_;
  double size_;
  ExitWorkspace& workspace_;
  ConvexExit exit_{.upper = std::numeric_limits<double>::infinity()};
};

}  // namespace

ConvexExit exit_of_hulls(const Support& support, double size, ExitWorkspace& workspace) {
  return ExitSearch(support, size, workspace).find();
}

}  // namespace sdm::separate
