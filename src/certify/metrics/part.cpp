#include "certify/metrics/part.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "certify/hausdorff/nearest_face.h"
#include "certify/hausdorff/part.h"
#include "closest/blocks.h"
#include "closest/closest_points.h"
#include "geometry/point_triangle.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "tree/visit.h"

namespace sdm::metrics {
namespace {

double mean_of(double a, double b, double c) {
  return (a + b + c) / 3;
}

double mean_square_of(double a, double b, double c) {
  return (a * a + b * b + c * c + a * b + b * c + c * a) / 6;
}

}  // namespace

Linear::Linear(const Vec3& at_corners) : a_(at_corners[0]), b_(at_corners[1]), c_(at_corners[2]) {
  if (a_ > b_) std::swap(a_, b_);
  if (b_ > c_) std::swap(b_, c_);
  if (a_ > b_) std::swap(a_, b_);
}

// The triangle next to a corner is similar to the whole one along both sides.
double Linear::fraction_at(double at, double limit, double other, double third) const {
  return (limit - at) / (other - at) * ((limit - at) / (third - at));
}

double Linear::fraction_within(double limit) const {
  if (limit >= c_) return 1;
  if (limit <= a_) return 0;
  return limit <= b_ ? fraction_at(a_, limit, b_, c_) : 1 - fraction_at(c_, limit, a_, b_);
}

// The part next to a corner with the other sign has the values (a, 0, 0) at its corners.
double Linear::mean() const {
  if (a_ >= 0) return mean_of(a_, b_, c_);
  if (c_ <= 0) return 0;
  if (b_ > 0) return mean_of(a_, b_, c_) - fraction_at(a_, 0, b_, c_) * mean_of(a_, 0, 0);
  return fraction_at(c_, 0, a_, b_) * mean_of(c_, 0, 0);
}

double Linear::mean_square() const {
  if (a_ >= 0) return mean_square_of(a_, b_, c_);
  if (c_ <= 0) return 0;
  if (b_ > 0) return mean_square_of(a_, b_, c_) - fraction_at(a_, 0, b_, c_) * mean_square_of(a_, 0, 0);
  return fraction_at(c_, 0, a_, b_) * mean_square_of(c_, 0, 0);
}

double TwoSided::fraction_within(double limit) const {
  const double a = a_.fraction_within(limit), b = b_.fraction_within(limit);
  return a == 1 ? b : b == 1 ? a : std::max(0.0, a + b - 1);
}

double TwoSided::least() const {
  return std::max({0.0, a_.least(), b_.least()});
}

double TwoSided::largest() const {
  return std::max({0.0, a_.largest(), b_.largest()});
}

namespace {

constexpr double kLeastLength = 1e-140;  // of a direction: its square does not underflow

double sum(const Vec3& v) {
  return v[0] + v[1] + v[2];
}

double square(double x) {
  return x * x;
}

double largest(const Vec3& v) {
  return std::max({v[0], v[1], v[2]});
}

/// The distances of the corners to a face of B, rounded upwards.
Vec3 upper_distances(const sites::SitesData& b, const FacePart& part, std::uint32_t face) {
  const Corners near = corners_of(b.mesh, face);
  Vec3 distances;
  for (int i = 0; i < 3; ++i) distances[i] = hausdorff::upper_face_distance(part.corner[i].at, near);
  return distances;
}

/// √(dᵢ² − G), or zeros if one of them is not real.
Vec3 lower_by_size(const FacePart& part) {
  const double most = (1 + kProductRounding) * part.squared_size() / 3;
  Vec3 low;
  for (int i = 0; i < 3; ++i) {
    const double d = part.corner[i].lower, squared = (1 - kFewRoundings) * d * d - most;
    if (!(squared > 0)) return {};
    low[i] = (1 - kFewRoundings) * std::sqrt(squared);
  }
  return low;
}

Vec3 unit_normal(const Corners& face) {
  const Vec3 normal = cross(face[1] - face[0], face[2] - face[0]);
  const double length = norm(normal);
  return length > kLeastLength ? (1 / length) * normal : Vec3{};
}

/// The vectors from the corners of a face of B to those of a part.
class Offsets {
 public:
  Offsets(const FacePart& part, const Corners& face) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const Vec3 r = part.corner[i].at - face[j];
        from_[i][j] = r;
        rounding_[i][j] = kProductRounding * (std::abs(r[0]) + std::abs(r[1]) + std::abs(r[2]));
      }
  }
  /// g·x − max of g·y over the face, at the corners x of the part; and the same for −g. Rounded downwards,
  /// also for a unit vector that is rounded.
  [[nodiscard]] std::array<Vec3, 2> along(const Vec3& g) const {
    std::array<Vec3, 2> low;
    for (int i = 0; i < 3; ++i) {
      double least = kInfinity, most = -kInfinity;
      for (int j = 0; j < 3; ++j) {
        const double d = dot(g, from_[i][j]);
        least = std::min(least, d - rounding_[i][j]);
        most = std::max(most, d + rounding_[i][j]);
      }
      low[0][i] = least;
      low[1][i] = -most;
    }
    return low;
  }

 private:
  Vec3 from_[3][3];
  double rounding_[3][3];
};

/// Lower bounds on the distance of a part from the faces that are added.
class LowerBounds {
 public:
  /// `nearest` separates the sides of B; no face that is not added is closer than `most`.
  LowerBounds(const FacePart& part, const Corners& nearest, double most)
      : part_(part),
        middle_(part.middle()),
        normal_(unit_normal(nearest)),
        low_{most, most, most},
        sides_{low_, low_} {
    add_to_sides(Offsets(part, nearest), normal_);  // so that both sides are not positive at once
  }

  void add(const Corners& face) {
    const Offsets offsets(part_, face);
    const Vec3 normal = unit_normal(face);
    const std::array<Vec3, 2> along = add_to_sides(offsets, normal);
    const bool above = dot(normal, middle_ - face[0]) >= 0, same = dot(normal, normal_) >= 0;
    Vec3 best{};
    double least = loss(best);
    const auto offer = [&](const Vec3& low) {
      if (const double l = loss(low); l < least) {
        best = low;
        least = l;
      }
    };
    if (normal != Vec3{}) offer(along[above == same ? 0 : 1]);
    if (least > 0) {
      const Vec3 way = middle_ - core::closest_on_triangle(middle_, face);
      if (const double length = norm(way); length > kLeastLength) offer(offsets.along((1 / length) * way)[0]);
    }
    for (int i = 0; i < 3; ++i) low_[i] = std::min(low_[i], best[i]);
  }

  /// A linear bound: of those along the normals of the faces and along the way from their closest point to
  /// the middle, the ones that are the least below `high`.
  [[nodiscard]] const Vec3& low() const { return low_; }
  /// Linear bounds on the distance to each side of B.
  [[nodiscard]] const std::array<Vec3, 2>& of_sides() const { return sides_; }

 private:
  [[nodiscard]] double loss(const Vec3& low) const {
    double total = 0;
    for (int i = 0; i < 3; ++i) total += std::max(0.0, part_.corner[i].upper - low[i]);
    return total;
  }
  /// Returns the bounds along the normal of the face, turned to the side of that of the nearest one, and
  /// along its opposite.
  std::array<Vec3, 2> add_to_sides(const Offsets& offsets, Vec3 normal) {
    if (dot(normal, normal_) < 0) normal = -1.0 * normal;
    const std::array<Vec3, 2> own = offsets.along(normal), nearest = offsets.along(normal_);
    for (const int side : {0, 1}) {
      const Vec3& bound = sum(own[side]) > sum(nearest[side]) ? own[side] : nearest[side];
      for (int i = 0; i < 3; ++i) sides_[side][i] = std::min(sides_[side][i], bound[i]);
    }
    return own;
  }

  const FacePart& part_;
  const Vec3 middle_, normal_;
  Vec3 low_;
  std::array<Vec3, 2> sides_;
};

/// The bounds |s| + p by the plane of a face, if the part crosses it. `distances`: of the corners to the
/// face.
std::optional<std::array<Vec3, 2>> upper_by_plane(const FacePart& part, const Corners& face,
                                                  const Vec3& distances) {
  const Vec3 normal = unit_normal(face);
  std::array<Vec3, 2> high{};
  bool above = false, below = false;
  for (int i = 0; i < 3; ++i) {
    const Vec3 r = part.corner[i].at - face[0];
    const double s = dot(normal, r);
    const double rounding = kProductRounding * (std::abs(r[0]) + std::abs(r[1]) + std::abs(r[2]));
    const double least = std::max(0.0, std::abs(s) - rounding), d = distances[i];
    const double p = (1 + kFewRoundings) * std::sqrt(std::max(0.0, (d - least) * (d + least)));
    (s > 0 ? above : below) = true;
    high[0][i] = s + p + rounding;
    high[1][i] = -s + p + rounding;
  }
  return above && below && normal != Vec3{} ? std::optional(high) : std::nullopt;
}

// Lowers `high` if the distance to this face is less.
void offer(const sites::SitesData& b, std::uint32_t face, FacePart& part) {
  const Vec3 distances = upper_distances(b, part, face);
  double mean = part.upper().mean();
  const auto take = [&](const std::array<Vec3, 2>& high) {
    if (const double m = TwoSided(high[0], high[1]).mean(); m < mean) {
      mean = m;
      part.high = high;
    }
  };
  take({distances, Vec3{}});
  if (const auto high = upper_by_plane(part, corners_of(b.mesh, face), distances)) take(*high);
}

void raise(FacePart& part, const std::array<Vec3, 2>& low) {
  if (TwoSided(low[0], low[1]).mean() > part.lower().mean()) part.low = low;
}

}  // namespace

std::vector<MeasuredPoint> measure(const sites::SitesData& b, std::span<const Vec3> points, double accuracy,
                                   const Progress& progress, double far) {
  std::vector<MeasuredPoint> result(points.size());
  closest::for_each_block(points.size(), progress, "parts", [&](std::size_t begin, std::size_t end) {
    closest::closest_points(b, points.subspan(begin, end - begin), kInfinity,
                            [&](std::size_t first, const sites::ClosestPacket& closest) {
                              for (std::size_t i = 0; i < closest.count; ++i) {
                                const Vec3& p = points[begin + first + i];
                                const std::uint32_t face = b.face_of(closest.type[i], closest.site[i]);
                                const double upper =
                                    hausdorff::upper_face_distance(p, corners_of(b.mesh, face));
                                MeasuredPoint& point = result[begin + first + i];
                                point = {p, face, std::max(0.0, closest.distance[i] - accuracy), upper};
                                if (upper >= far * accuracy) continue;
                                const hausdorff::NearestFace nearest = hausdorff::nearest_face(b, p, face);
                                point.nearest = nearest.face;
                                point.lower = nearest.lower;
                                point.upper = nearest.upper;
                              }
                            });
  });
  return result;
}

double FacePart::gap() const {
  double most = 0;
  for (const Vec3& h : high)
    most = std::max(most, std::min({largest(h), largest(h - low[0]), largest(h - low[1])}));
  return most;
}

double FacePart::closest_bounds(double accuracy) const {
  double most = 0;
  for (const MeasuredPoint& point : corner) most = std::max(most, point.upper - point.lower);
  return std::max(2 * most, kProductRounding * accuracy);
}

double FacePart::squared_size() const {
  const int i = longest_side();
  return squared_norm(corner[(i + 1) % 3].at - corner[i].at);
}

int FacePart::longest_side() const {
  int longest = 0;
  double most = -1;
  for (int i = 0; i < 3; ++i)
    if (const double squared = squared_norm(corner[(i + 1) % 3].at - corner[i].at); squared > most) {
      most = squared;
      longest = i;
    }
  return longest;
}

Vec3 FacePart::middle() const {
  return (1.0 / 3) * (corner[0].at + corner[1].at + corner[2].at);
}

void bound(const sites::SitesData& b, FacePart& part) {
  offer(b, part.nearest, part);  // often less far from all corners than the faces that are closest to one
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t face = part.corner[i].nearest;
    if (face != part.nearest && (i == 0 || face != part.corner[i - 1].nearest)) offer(b, face, part);
  }
  raise(part, {lower_by_size(part), Vec3{}});
}

void bound_thoroughly(const sites::SitesData& b, FacePart& part) {
  constexpr int kMostFaces = 48;  // more are nearly equally far, where lower_by_size() is close
  part.thorough = true;
  const double most = part.upper().largest();
  if (most == 0) return;
  Box box, unit_box;
  double size = 1;
  for (const MeasuredPoint& corner : part.corner) {
    const Vec3 unit = b.frame.to_unit(corner.at);
    extend(box, corner.at);
    extend(unit_box, unit);
    for (const double x : unit) size = std::max(size, std::abs(x));
  }
  const tree::FloatBox around = tree::FloatBox::around(unit_box);
  const double max_distance = (1 + kProductRounding) * most * b.frame.scale + kProductRounding * size;
  // Faces farther than `max_distance` are closest nowhere, or as far as `high` is anyway.
  const auto is_far = [&, most_squared = square(max_distance / b.frame.scale)](const Corners& face) {
    double squared = 0;
    for (int k = 0; k < 3; ++k) {
      const auto [lo, hi] = std::minmax({face[0][k], face[1][k], face[2][k]});
      squared += square(std::max({0.0, lo - box.upper[k], box.lower[k] - hi}));
    }
    return squared > most_squared;
  };
  LowerBounds bounds(part, corners_of(b.mesh, part.nearest), most);
  int faces = 0;
  const auto gap_to = [&](const tree::FloatBox& other) { return norm(tree::gap(around, other)); };
  const auto enter = [&](double distance) { return faces <= kMostFaces && distance <= max_distance; };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t face : b.tree.items_of(node)) {
      const Corners corners = corners_of(b.mesh, face);
      if (is_far(corners)) continue;
      if (++faces > kMostFaces) return;
      bounds.add(corners);
    }
  };
  tree::visit(b.tree, tree::NearestFirst{gap_to, enter, leaf});
  if (faces > kMostFaces) return;
  raise(part, {bounds.low(), Vec3{}});
  raise(part, bounds.of_sides());
}

std::array<Vec3, 2> Cut::of(const FacePart& part) const {
  const auto between = [&](int i, int j, double t) {
    return (1 - t) * part.corner[i].at + t * part.corner[j].at;
  };
  const int next = (corner + 1) % 3, last = (corner + 2) % 3;
  if (points == 1) return {between(next, last, at[0]), Vec3{}};
  return {between(corner, next, at[0]), between(corner, last, at[1])};
}

Cut choose_cut(const sites::SitesData& b, const FacePart& part) {
  constexpr double kLeast = 1e-6, kSmaller = 0.5;  // of the part
  const Cut halved{.corner = (part.longest_side() + 2) % 3};
  const double size = std::sqrt(part.squared_size());
  if (!(part.upper().largest() < size)) return halved;
  const Corners face = corners_of(b.mesh, part.nearest);
  const Vec3 normal = unit_normal(face);
  if (hausdorff::longest_side(face) < kSmaller * size || normal == Vec3{}) return halved;
  const Corners at{part.corner[0].at, part.corner[1].at, part.corner[2].at};
  const auto cut = hausdorff::cut_along_side(at, face, normal, 0, kLeast * size);
  return cut ? Cut{.corner = cut->alone, .points = 2, .at = cut->at} : halved;
}

std::vector<FacePart> pieces(const FacePart& part, const Cut& cut, std::span<const MeasuredPoint> points) {
  std::vector<FacePart> result;
  const auto add = [&](double share) -> FacePart& {
    FacePart& piece = result.emplace_back(part);
    piece.area = share * part.area;
    piece.thorough = false;
    return piece;
  };
  // Corner `to` of a piece becomes the point of the side from `i` to `j`.
  const auto set = [&](FacePart& piece, int to, const MeasuredPoint& point, int i, int j, double t) {
    piece.corner[to] = point;
    for (const int k : {0, 1}) {
      piece.low[k][to] = (1 - t) * part.low[k][i] + t * part.low[k][j];
      piece.high[k][to] = (1 - t) * part.high[k][i] + t * part.high[k][j];
    }
  };
  const int i = cut.corner, j = (i + 1) % 3, k = (i + 2) % 3;
  const auto [s, t] = cut.at;
  if (cut.points == 1) {
    set(add(s), k, points[0], j, k, s);
    set(add(1 - s), j, points[0], j, k, s);
    return result;
  }
  result.reserve(3);
  FacePart& tip = add(s * t);
  set(tip, j, points[0], i, j, s);
  set(tip, k, points[1], i, k, t);
  set(add(1 - s), i, points[0], i, j, s);
  FacePart& rest = add(s * (1 - t));
  set(rest, i, points[1], i, k, t);
  set(rest, j, points[0], i, j, s);
  return result;
}

}  // namespace sdm::metrics
