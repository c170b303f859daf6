#include "inside/inside.h"

#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "geometry/vec.h"
#include "inside/sign.h"
#include "inside/solid.h"
#include "rays/trace.h"
#include "sites/sites_data.h"

namespace sdm::inside {
namespace {

/// Winding numbers of points of solids, one from another. Keeps the last points p with their numbers w(p),
/// each with a clear ball around it, which no face meets. For a new point q,
///   w(q) = w(p) + the signed crossings of the segment from q to p,
/// with the p whose ball is nearest to that of q: 0 crossings if the balls overlap, otherwise those of the
/// part between them. If the way out of the box is shorter, w(q) is the signed crossings of that.
class WindingWalk {
 public:
  /// Prepares for points that are near each other: nodes of the tree near all of them are searched once.
  void approach(const ShapeSigns& signs, const sites::SitesData& solid, std::span<const Vec3> points);
  /// The winding number of a point with a clear ball of radius `clear` > 0. With `by_balls`, empty unless
  /// balls overlap, as long as this is rare.
  [[nodiscard]] std::optional<int> winding(const ShapeSigns& signs, const sites::SitesData& solid,
                                           const Vec3& point, double clear, bool by_balls);

 private:
  static constexpr std::size_t kKept = 16;

  void start(std::uint64_t shape);
  void keep(const Vec3& point, double clear, int number);

  std::uint64_t shape_ = 0;
  std::array<std::array<double, kKept>, 3> at_{};
  std::array<double, kKept> clear_{};  ///< −∞ where none is kept
  std::array<int, kKept> number_{};
  std::size_t next_ = 0;
  double overlapping_ = 1;  ///< the share of points whose balls overlap others, of the last ones
  Box prepared_box_;
  bool prepared_ = false;
  rays::NearNodes prepared_nodes_;
};

double way_out(const Box& box, const Vec3& point) {
  double way = kInfinity;
  for (int k = 0; k < 3; ++k) way = std::min({way, point[k] - box.lower[k], box.upper[k] - point[k]});
  return std::max(way, 0.0);
}

void WindingWalk::start(std::uint64_t shape) {
  if (shape == shape_) return;
  shape_ = shape;
  prepared_ = false;
  overlapping_ = 1;
  clear_.fill(-kInfinity);
}

void WindingWalk::keep(const Vec3& point, double clear, int number) {
  next_ = (next_ + 1) % kKept;
  for (int k = 0; k < 3; ++k) at_[static_cast<std::size_t>(k)][next_] = point[k];
  clear_[next_] = clear;
  number_[next_] = number;
}

void WindingWalk::approach(const ShapeSigns& signs, const sites::SitesData& solid,
                           std::span<const Vec3> points) {
  start(signs.number);
  prepared_ = false;  // also if this fails
  prepared_box_ = {};
  for (const Vec3& p : points) extend(prepared_box_, p);
  // The point before is mostly near, too.
  if (std::isfinite(clear_[next_])) extend(prepared_box_, Vec3{at_[0][next_], at_[1][next_], at_[2][next_]});
  // More than the rounding of segments.
  const Vec3 margin{1e-5, 1e-5, 1e-5};
  rays::find_near_nodes(solid,
                        tree::FloatBox::around({solid.frame.to_unit(prepared_box_.lower) - margin,
                                                solid.frame.to_unit(prepared_box_.upper) + margin}),
                        prepared_nodes_);
  prepared_ = true;
}

std::optional<int> WindingWalk::winding(const ShapeSigns& signs, const sites::SitesData& solid,
                                        const Vec3& point, double clear, bool by_balls) {
  constexpr double kMostly = 0.4, kNew = 0.05;
  start(signs.number);
  std::array<double, kKept> gap;
  for (std::size_t i = 0; i < kKept; ++i) {
    const double x = at_[0][i] - point[0], y = at_[1][i] - point[1], z = at_[2][i] - point[2];
    gap[i] = std::sqrt(x * x + y * y + z * z) - clear_[i];
  }
  const auto best = static_cast<std::size_t>(std::ranges::min_element(gap) - gap.begin());
  const bool overlap = gap[best] < clear;
  overlapping_ += kNew * ((overlap ? 1 : 0) - overlapping_);
  if (by_balls && !overlap && overlapping_ < kMostly) return {};
  std::optional<int> number;
  if (overlap) {
    number = number_[best];
  } else if (gap[best] - clear < way_out(signs.box, point)) {
    const Vec3 from{at_[0][best], at_[1][best], at_[2][best]};
    const double length = norm(from - point);
    const bool prepared =
        prepared_ && sdm::contains(prepared_box_, from) && sdm::contains(prepared_box_, point);
    // Only the part between the two balls can meet faces.
    const auto turns = crossings(solid, {point, from, clear / length, 1 - clear_[best] / length},
                                 prepared ? &prepared_nodes_ : nullptr);
    if (turns) number = number_[best] + *turns;
  }
  const int found = number ? *number : inside::winding(solid, point);
  keep(point, clear, found);
  return found;
}

// Clear balls, which the surface does not meet, each with an answer that holds for its points within the safe
// radius of its centre c, and for the centre q of a clear ball that overlaps it: the segment from c to q lies
// in both, and so meets no face.
//
//   ( c ·····)(···· q )     |q − c| < min(r + r_q, safe radius), which is infinite for a solid
class ClearBalls {
 public:
  // The answer for the centre of a clear ball, if it overlaps a known one of the shape with this number.
  [[nodiscard]] std::optional<bool> find(std::uint64_t shape, const Vec3& centre, double radius) const {
    if (shape != shape_) return {};
    for (const Ball& ball : balls_) {
      const double touching = std::min(radius + ball.radius, ball.safe_radius);
      if (squared_norm(centre - ball.centre) < touching * touching && ball.radius > 0) return ball.inside;
    }
    return {};
  }
  struct Ball {
    Vec3 centre{};
    double radius = 0, safe_radius = 0;
    bool inside = false;
  };
  void add(std::uint64_t shape, const Ball& ball) {
    if (shape != shape_) {
      balls_ = {};
      shape_ = shape;
    }
    next_ = (next_ + 1) % balls_.size();
    balls_[next_] = ball;
  }

 private:
  std::uint64_t shape_ = 0;
  std::size_t next_ = 0;
  std::array<Ball, 8> balls_{};
};
thread_local ClearBalls balls;

// Exponential back-off on this thread: after the n-th failure in a row, the next min(2ⁿ − 1, 15) trials are
// left out. Answers do not depend on it.
class ExponentialBackOff {
 public:
  [[nodiscard]] bool due(std::uint64_t shape) {
    if (shape != shape_) {
      *this = {};
      shape_ = shape;
    }
    if (to_skip_ == 0) return true;
    --to_skip_;
    return false;
  }
  void learn(bool paid) {
    constexpr std::uint32_t kMostSkipped = 15;
    skipped_ = paid ? 0 : std::min(2 * skipped_ + 1, kMostSkipped);
    to_skip_ = skipped_;
  }

 private:
  std::uint64_t shape_ = 0;
  std::uint32_t to_skip_ = 0, skipped_ = 0;
};
thread_local ExponentialBackOff packet_trials, ball_trials;

thread_local WindingWalk winding_walk;

// How far from the surface, in sizes of a packet, points are searched together that are far from each other,
// or whose sums have few faces.
constexpr double kWidestOfSparse = 0.25;

// The answer of a test of a solid, which holds as far as clear balls overlap.
WindingNumber::Side of_solid(bool inside) {
  return {inside, kInfinity};
}

}  // namespace

InsideTest::InsideTest(const sites::SitesData& sites, SignMethod method, double error)
    : sites_(sites), method_(method), error_(error) {
  refit();
}

void InsideTest::refit() {
  if (method_ == SignMethod::none) return;
  signs_ = &signs_of(sites_);
  if (method_ == SignMethod::exact) sides_ = &signs_->sides();
  if (method_ == SignMethod::winding) winding_ = &signs_->winding();
  if (method_ == SignMethod::side) boundary_ = &signs_->boundary();
}

bool InsideTest::inside_solid(const Vec3& query, const ClosestPoint& closest) const {
  const Sides sides = sides_->of_site(closest.type, closest.site);
  switch (sides) {
    case Sides::buried:
      return true;
    case Sides::mixed:
      return closest.distance > 0 && winding(sites_, query) != 0;
    default: {
      const double outward =
          dot(query - closest.point, sites::pseudonormal(sites_.normals, sites_.topology, closest));
      return sides == Sides::boundary ? outward < 0 : outward > 0;
    }
  }
}

bool InsideTest::behind(const Vec3& query, const ClosestPoint& closest) const {
  if (closest.type == SiteType::none || boundary_->contains(closest.type, closest.site)) return false;
  return dot(query - closest.point, sites::pseudonormal(sites_.normals, sites_.topology, closest)) < 0;
}

double InsideTest::clear_radius(SiteType type, double distance) const {
  // Distances of queries far from O2 may be too long by a fraction of themselves.
  constexpr double kRelative = 4e-6;
  const double far = method_ == SignMethod::winding ? kRelative * distance : 0;
  return type == SiteType::none ? 0 : std::max(0.0, distance - far - std::max(signs_->clearance, error_));
}

template <class Test>
bool InsideTest::inside_ball(const Vec3& query, SiteType type, double distance, const Test& test) const {
  const double radius = clear_radius(type, distance);
  if (!(radius > 0)) return test(0.0).above;
  if (const auto known = balls.find(signs_->number, query, radius)) return *known;
  const WindingNumber::Side side = test(radius);
  balls.add(signs_->number, {query, radius, side.safe_radius, side.above});
  return side.above;
}

bool InsideTest::test(const Vec3& query, const ClosestPoint& closest, bool few) const {
  switch (method_) {
    case SignMethod::exact:
      if (closest.type == SiteType::none || !sdm::contains(signs_->box, query)) return false;
      return inside_ball(query, closest.type, closest.distance, [&](double clear) {
        if (few && clear > 0 && sides_->direct(sites_.face_of(closest.type, closest.site)))
          return of_solid(*winding_walk.winding(*signs_, sites_, query, clear, false) != 0);
        return of_solid(inside_solid(query, closest));
      });
    case SignMethod::winding:
      if (closest.distance == 0) return false;
      return inside_ball(query, closest.type, closest.distance,
                         [&](double clear) { return above_half(query, closest, few, clear); });
    case SignMethod::side:
      return behind(query, closest);
    default:
      return false;
  }
}

bool InsideTest::operator()(const Vec3& query, const ClosestPoint& closest) const {
  return test(query, closest, false);
}

bool InsideTest::of_few(const Vec3& query, const ClosestPoint& closest) const {
  return test(query, closest, true);
}

bool InsideTest::at_boundary(const Vec3& query, const ClosestPoint& closest) const {
  switch (sides_->of_site(closest.type, closest.site)) {
    case Sides::boundary:
    case Sides::reversed:
      return true;
    case Sides::buried:
      return false;
    default: {
      // No face lies between the two; whether the solid goes on behind the closest point remains to be found.
      const Vec3 beyond = closest.point + 0.25 * signs_->clearance * normalized(closest.point - query);
      return winding(sites_, beyond) == 0;
    }
  }
}

InsideTest::Beside InsideTest::beside(const Vec3& p) const {
  // A direction along which faces are unlikely to lie.
  constexpr Vec3 kAlong{0.7266, 0.5485, 0.4141};
  Vec3 beside;
  for (int corner = 0; corner < 8; ++corner) {
    for (int k = 0; k < 3; ++k)
      beside[k] = p[k] + ((corner >> k & 1) != 0 ? 0.25 : -0.25) * signs_->clearance * kAlong[k];
    if (winding(sites_, beside) == 0) return {beside, false};
  }
  return {beside, true};
}

// Tries to decide a ball around the query. Larger ones meet the surface in places, and are rarely decided.
WindingNumber::Side InsideTest::above_half(const Vec3& query, const ClosestPoint& closest, bool few,
                                           double clear) const {
  constexpr double kOfClear = 0.15;
  const bool due = clear > 0 && ball_trials.due(signs_->number);
  const double radius = due ? kOfClear * clear : 0;
  const WindingNumber::Side side = winding_->above_half(query, closest, few, radius);
  if (due) ball_trials.learn(side.safe_radius >= radius);
  return side;
}

// Balls first; then one search for all others, unless a ball of one of them contains the rest; then one by
// one.
template <class Closest>
std::uint32_t InsideTest::above_half(std::span<const Vec3> queries, const Closest& closest, bool few,
                                     double widest) const {
  constexpr std::size_t kFewest = 4;
  std::array<Vec3, kPacket> open_queries;
  std::array<ClosestPoint, kPacket> open_closest;
  std::array<std::uint8_t, kPacket> place;
  std::size_t count = 0;
  std::uint32_t inside = 0;
  double largest = 0;
  std::size_t largest_place = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const ClosestPoint at = closest(i);
    if (at.distance == 0) continue;
    const double radius = clear_radius(at.type, at.distance);
    if (const auto known = balls.find(signs_->number, queries[i], radius)) {
      inside |= (*known ? 1u : 0u) << i;
      continue;
    }
    if (radius > largest) {
      largest = radius;
      largest_place = count;
    }
    open_queries[count] = queries[i];
    open_closest[count] = at;
    place[count++] = static_cast<std::uint8_t>(i);
  }
  if (count == 0) return inside;
  // The ball of the first one that is tested may answer for the others.
  std::swap(open_queries[0], open_queries[largest_place]);
  std::swap(open_closest[0], open_closest[largest_place]);
  std::swap(place[0], place[largest_place]);
  PacketSides sides;
  if (count >= kFewest) {
    Box box;
    for (const Vec3& query : std::span(open_queries).first(count)) extend(box, query);
    if (largest < widest * norm(box.upper - box.lower) && packet_trials.due(signs_->number)) {
      sides = winding_->above_half(std::span(open_queries).first(count), std::span(open_closest).first(count),
                                   few);
      packet_trials.learn(2 * static_cast<std::size_t>(std::popcount(sides.known)) >= count);
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    const bool is_inside = (sides.known >> k & 1u) != 0 ? (sides.above >> k & 1u) != 0
                                                        : test(open_queries[k], open_closest[k], few);
    inside |= (is_inside ? 1u : 0u) << place[k];
  }
  return inside;
}

std::uint32_t InsideTest::operator()(std::span<const Vec3> queries, std::span<const ClosestPoint> closest,
                                     bool few) const {
  if (method_ == SignMethod::winding)
    return above_half(
        queries, [&](std::size_t i) { return closest[i]; }, few, kWidestOfSparse);
  std::uint32_t inside = 0;
  const bool dense = method_ == SignMethod::exact && !few && sides_->walked(queries.size());
  if (dense) winding_walk.approach(*signs_, sites_, queries);
  for (std::size_t i = 0; i < queries.size(); ++i)
    inside |= ((dense ? dense_test(queries[i], closest[i]) : test(queries[i], closest[i], few)) ? 1u : 0u)
              << i;
  return inside;
}

// Tests a point by those near it, without the sides of faces, where these points mostly lead to it.
bool InsideTest::dense_test(const Vec3& query, const ClosestPoint& closest) const {
  if (closest.type == SiteType::none || !sdm::contains(signs_->box, query)) return false;
  const double clear = clear_radius(closest.type, closest.distance);
  if (clear > 0)
    if (const auto number = winding_walk.winding(*signs_, sites_, query, clear, true)) return *number != 0;
  return inside_solid(query, closest);
}

std::uint32_t InsideTest::operator()(std::span<const Vec3> queries,
                                     const sites::ClosestPacket& closest) const {
  std::uint32_t inside = 0;
  if (method_ == SignMethod::none) return inside;
  const auto of = [&](std::size_t i) { return closest.get(i, queries[i]); };
  // Samples of a surface or a grid are close together.
  constexpr double kWidest = 4;
  if (method_ == SignMethod::winding)
    return above_half(queries.first(closest.count), of, false,
                      winding_->sums_many_faces() ? kWidest : kWidestOfSparse);
  for (std::size_t i = 0; i < closest.count; ++i) {
    const Vec3& query = queries[i];
    bool is_inside = false;
    if (method_ != SignMethod::exact)
      is_inside = test(query, of(i), false);
    else if (sdm::contains(signs_->box, query) && closest.type[i] != SiteType::none)
      is_inside = inside_ball(query, closest.type[i], closest.distance[i],
                              [&](double) { return of_solid(inside_solid(query, of(i))); });
    inside |= static_cast<std::uint32_t>(is_inside) << i;
  }
  return inside;
}

}  // namespace sdm::inside
